#pragma once

#include <cstdint>
#include <vector>

#include "saccade/core/frame.hpp"
#include "simulation/random_hash.hpp"

namespace saccade {

/// Where the camera is and what it looks at.
struct Viewpoint {
  Eigen::Vector3d eye_W;
  Eigen::Vector3d target_W;
};

/// A hand-held camera's closed path through viewpoints: a cubic B-spline, smooth in place and direction, walked at an
/// even pace, plus a hand's tremor. No step between frames is larger than 2 cm or 1.5 degrees.
class CameraPath {
 public:
  /// Walks the loop in `loop_frames`, or in as many more as the pace of a careful person needs. `turns` are loops over
  /// several viewpoints, at least four. Throws std::invalid_argument for fewer.
  CameraPath(std::vector<Viewpoint> turns, std::int64_t loop_frames, std::uint64_t seed);

  /// T_WC at a frame from 0 on; after the loop it begins again.
  [[nodiscard]] Pose at(std::int64_t frame) const;
  [[nodiscard]] std::int64_t loopFrames() const { return loop_frames_; }

 private:
  [[nodiscard]] Viewpoint onSpline(double place) const;  // place in 0 .. number of viewpoints

  std::vector<Viewpoint> turns_;
  std::int64_t loop_frames_;
  std::vector<double> effort_;  // walked up to each sample, in shares of the largest step
  double phase_[6];
};

/// Viewpoints on an arc around `middle_W`: `radius_m` away, `height_m` above it, azimuths within +-`reach` of
/// `azimuth` (counted from +x), there and back.
[[nodiscard]] std::vector<Viewpoint> orbit(const Eigen::Vector3d& middle_W, double radius_m, double height_m,
                                           double azimuth, double reach, RandomStream& random);

/// Viewpoints that wander at random over a box of places while the look wanders over a box of targets.
[[nodiscard]] std::vector<Viewpoint> wander(const Eigen::AlignedBox3d& eyes_W, const Eigen::AlignedBox3d& targets_W,
                                            int count, RandomStream& random);

/// Viewpoints past a front of furniture from a to b and back, looking at it squarely from `distance_m` to the left of
/// a-b, along at `target_height_m`.
[[nodiscard]] std::vector<Viewpoint> sweep(const Eigen::Vector2d& a_W, const Eigen::Vector2d& b_W, double distance_m,
                                           double eye_height_m, double target_height_m, RandomStream& random);

}  // namespace saccade
