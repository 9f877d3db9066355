#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "map/depth_windows.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {

/// Fuses one depth image into bricks by the rule of Newcombe et al. 2011: the distance along the ray, truncated before
/// the surface, is averaged by weight into all samples less than the band behind it. Leaves to the volume which bricks
/// there are. Keeps a pointer to the image.
class BrickFusion {
 public:
  /// Takes the image, seen from `T_WC`. Throws nothing: the volume has checked both.
  void begin(const DepthMaps& depth, const Pose& T_WC, const SurfaceVolumeConfig& config);

  /// Fills `reached` with the indices of those bricks around `centres`, in the camera frame, that are not wholly hidden
  /// or out of sight. Some that learn nothing may be among them.
  void findReached(const std::vector<Eigen::Vector3f>& centres, std::vector<std::int32_t>& reached) const;

  /// Updates the brick around `centre`, in the camera frame; returns whether a sample was observed.
  bool fuse(const Eigen::Vector3f& centre, SurfaceBrick& brick) const;

  struct Projection {
    const float* depth;
    int width, height;
    float fx, fy, cx, cy;
    float band;         // metres
    float near_square;  // square metres
    float weight_cap;   // in 1 / kWeightScale observations
    float cell;         // metres
    std::array<float, 9> R_CW;
    alignas(32) std::array<std::array<float, SurfaceBrick::kSamples>, 3> samples;  // from the first, by axis, frame C
    alignas(32) std::array<std::array<float, 8>, 3> octants;  // from a brick's centre to those of its eighths, frame C
    std::array<float, 3> first;                               // from a brick's centre to its first sample, frame C
  };

 private:
  Projection projection_{};
  DepthWindows windows_;
};

}  // namespace saccade
