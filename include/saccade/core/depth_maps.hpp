#pragma once

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/config_fields.hpp"

namespace saccade {

/// Vertex and normal map of one depth image, in the camera frame C (Newcombe et al. 2011, "surface measurement").
///
/// All images have the camera's size. A pixel without measurement has depth 0 and vertex and normal (0, 0, 0); a
/// measured pixel whose neighbourhood is too broken for a normal has normal (0, 0, 0).
struct DepthMaps {
  PinholeCamera camera;
  cv::Mat1f depth_m;   ///< as measured, along the optical axis, limited to the working range; what maps integrate
  cv::Mat3f vertices;  ///< metres, frame C; behind the same pixels as `depth_m`, but from the smoothed depth
  cv::Mat3f normals;   ///< unit length, frame C, turned towards the camera: normal · vertex < 0
};

/// How a raw depth image becomes DepthMaps.
struct DepthPreparationConfig {
  double min_range_m = 0.3;
  double max_range_m = 4.0;
  /// A structured-light or stereo camera errs by a constant amount in inverse depth, whatever the distance; so
  /// tolerances are inverse depths. 0.0028 1/m is one disparity step of a Kinect: 3 mm at 1 m, 25 mm at 3 m.
  double smoothing_tolerance_per_m = 0.012;
  int smoothing_radius_px = 2;  ///< 0: vertices are the measured points
  double normal_tolerance_per_m = 0.012;
  int normal_radius_px = 4;

  void describe(ConfigVisitor& visitor);
};

/// Turns depth images into vertex and normal maps. Owns its scratch images and recycles them, as well as the buffers of
/// the DepthMaps handed in; it keeps nothing of one frame for the next. One object per thread.
class DepthPreparation {
 public:
  using Config = DepthPreparationConfig;

  /// Throws std::invalid_argument if a field of `config` is out of range or the range is empty.
  explicit DepthPreparation(const Config& config = {});

  /// Fills `maps` from `depth_m` (metres along the optical axis, of the camera's size; 0, negative, NaN and infinite
  /// values are no measurement). Smoothing is edge preserving (bilateral, in inverse depth, rows then columns). Normals
  /// come from the slope of the inverse depth, which on a plane is exactly linear in (u, v); pixel pairs that straddle
  /// a depth discontinuity are not linear and are left out, so no normal crosses one. A few ms at 640x480, one thread.
  /// Throws std::invalid_argument if the image has another size than the camera.
  void prepare(const cv::Mat1f& depth_m, const PinholeCamera& camera, DepthMaps& maps);

  [[nodiscard]] const Config& config() const { return config_; }

 private:
  void smooth(int width, int height);

  Config config_;
  cv::Mat1f inverse_depth_;  ///< 1/m, 0 = no measurement, with a margin of zeros
  cv::Mat1f smoothed_;       ///< the same after smoothing along rows, with the same margin
};

/// DepthPreparation with the default configuration for a single image; allocates.
[[nodiscard]] DepthMaps prepareDepth(const cv::Mat1f& depth_m, const PinholeCamera& camera);

}  // namespace saccade
