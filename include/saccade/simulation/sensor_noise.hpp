#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"
#include "saccade/simulation/scene_renderer.hpp"

namespace saccade {

struct SensorNoiseConfig {
  double strength = 1.0;      ///< factor on all noise; 0 = an ideal sensor
  double focal_px = 570.0;    ///< of the simulated depth sensor
  double baseline_m = 0.075;  ///< between its projector and its camera
  double disparity_step_px = 0.125;
  double nearest_m = 0.4;    ///< no depth below
  double farthest_m = 6.0;   ///< no depth beyond
  double color_sigma = 2.0;  ///< grey levels
  /// The depth camera beside the colour camera, in whose image depth is given: along the strips that it does not see,
  /// there is none. View and shift for what is far away, the left offset for parallax.
  double view_share = 1.0;  ///< of the image's width and height
  double view_right_px = 0.0, view_down_px = 0.0;
  double camera_left_m = 0.0;

  void describe(ConfigVisitor& visitor);
};

/// Makes exact images look like a Kinect's: axial noise that grows with the square of the distance
/// (1.2 mm + 1.9 mm/m² (z - 0.4 m)², Nguyen et al. 2012), disparity steps, the projector's shadow to the left of
/// things, wavering depth edges with dropouts, gaps where a surface is seen at a grazing angle, on dark and on
/// mirroring places, strips that the depth camera does not see, and grey-level noise in colour. Depth errs over a few
/// pixels together, as the sensor matches windows.
///
/// Every random number is a hash of (seed, frame, pixel): the same at any order of frames and any number of
/// threads, of which it uses all. One caller at a time.
class SensorNoise {
 public:
  using Config = SensorNoiseConfig;

  explicit SensorNoise(std::uint64_t seed, const Config& config = {});

  /// Changes `color` and `depth_m` in place; strength 0 changes nothing, not even the range.
  void apply(std::int64_t frame, SceneImages& images);

 private:
  void applyToDepth(std::uint64_t stream, std::uint64_t gaps, SceneImages& images);
  [[nodiscard]] float measured(std::uint64_t stream, std::uint64_t gaps, int u, int v, const SceneImages& images) const;
  [[nodiscard]] bool isInView(int u, int v, float z) const;
  void markShadows(int row, std::vector<bool>& in_shadow) const;
  void applyToColor(std::uint64_t stream, cv::Mat3b& color) const;

  std::uint64_t seed_;
  Config config_;
  cv::Mat1f exact_;
};

}  // namespace saccade
