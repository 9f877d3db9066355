#pragma once

#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

/// The part of the world that a look may touch: the camera's frustum down to a depth, grown by a margin on all sides.
class ViewRegion {
 public:
  /// `farthest_m`: depth along the optical axis. Throws std::invalid_argument unless the pose is finite and both
  /// lengths are at least 0.
  ViewRegion(const PinholeCamera& camera, const Pose& T_WC, double farthest_m, double margin_m);

  /// False only if no point of the box (in W, metres) is in the region; a box near an edge of the frustum may count as
  /// touched although it is not.
  [[nodiscard]] bool touches(const Eigen::AlignedBox3d& box_W) const;
  /// The camera's centre in W.
  [[nodiscard]] const Eigen::Vector3d& eye_W() const { return eye_W_; }

 private:
  /// Points p with normal.dot(p) + offset >= 0.
  struct HalfSpace {
    Eigen::Vector3d normal;
    double offset;
  };
  std::array<HalfSpace, 6> sides_;
  Eigen::Vector3d eye_W_;
};

}  // namespace saccade
