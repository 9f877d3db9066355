#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

namespace saccade {

/// Rigid transform named by its frames: `T_WC` takes camera points to world, `p_W = T_WC * p_C`. Metres.
using Pose = Eigen::Isometry3d;

/// Position of a frame in its input, before `--range` selects; a type of its own so that it is never taken for a tick.
struct FrameIndex {
  std::int64_t value = 0;
  friend auto operator<=>(const FrameIndex&, const FrameIndex&) = default;
};

/// One colour image with the depth image registered to it.
struct RgbdFrame {
  FrameIndex index;
  std::string name;  ///< stem of the colour file, or a running name for inputs without files
  double stamp_s = 0.0;
  cv::Mat3b color;           ///< BGR
  cv::Mat1f depth_m;         ///< along the optical axis, same size as `color`, 0 = no measurement; empty: colour only
  std::optional<Pose> T_WC;  ///< pose of the colour camera that the input itself gives, if it does and it is finite
  cv::Mat1w label;           ///< instance id per pixel, 0 = no object; empty where the input has none
};

}  // namespace saccade
