#pragma once

#include <optional>
#include <vector>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

/// How well neighbouring frames fit one another as views of one rigid scene.
struct RigidFit {
  std::int64_t segments = 0;       ///< short stretches of frames, the last of each aligned to the first
  std::int64_t lost_segments = 0;  ///< those that could not be aligned
  double turn_deg = 0.0;           ///< mean turn of the camera over a segment
  /// Residual of point-to-plane distances over squared depth, 1/m. It is the noise of inverse depth, a constant of the
  /// sensor: structured light and active stereo have about 0.001.
  double noise_per_m = 0.0;
  /// Length of the way by alignment over that by the poses of the input; none: no poses, or hardly any way.
  std::optional<double> way_ratio;
  /// The factor on the focal length with which the frames fit best, and how much worse they fit without it (a ratio of
  /// residuals, 1: no worse); none: the camera hardly turns.
  std::optional<double> focal_factor;
  double focal_penalty = 1.0;
};

/// Fits consecutive frames of `camera` to one another (point-to-plane ICP, the tracker's), for several focal lengths:
/// with a wrong one, the views of a turning camera are no longer views of one rigid scene. Depth is brought to a usual
/// range first, so a wrong scale of depth does not matter; lengths in the result are in the input's own scale. Some
/// seconds for 50 frames. None if the frames are too few or hold too little depth.
[[nodiscard]] std::optional<RigidFit> fitFrames(const std::vector<RgbdFrame>& frames, const PinholeCamera& camera);

}  // namespace saccade
