#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/depth_maps.hpp"

namespace saccade {

/// Unit normal in the camera frame, turned away from the camera; z = 0 stands for none.
struct SurfaceNormal {
  float x = 0.0F, y = 0.0F, z = 0.0F;
};

/// Smoothed inverse depths and normals of a depth image at half its size.
///
/// A plane's inverse depth is an affine function of the pixel, and the noise of a structured-light or stereo camera is
/// the same at all inverse depths (its depth noise grows with depth squared). So planes are fitted and compared here in
/// inverse depth (1/m), where one tolerance holds for all ranges. Owns its images; rows are the halved image's.
class SurfaceFits {
 public:
  /// Overwrites all fits. `max_step` (1/m): neighbouring pixels that differ by more, and by more than the slope on
  /// either side explains, lie on different surfaces.
  void compute(const DepthMaps& depth, float max_step);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Inverse depth per pixel, 1/m; 0 where no pixel of the block was measured. A block across a step takes the nearer
  /// side.
  [[nodiscard]] const std::vector<float>& inverseDepth() const { return inverse_depth_; }
  [[nodiscard]] const std::vector<SurfaceNormal>& normals() const { return normals_; }
  /// Gradient of the fitted inverse depth per pixel of the halved image, where there is a normal.
  [[nodiscard]] const std::vector<cv::Vec2f>& gradients() const { return gradients_; }
  /// 1 - cos of the largest angle between normals on opposite sides of the pixel's window; 2 where there is no normal.
  [[nodiscard]] const std::vector<float>& curvatures() const { return curvatures_; }

  /// The camera of the halved image.
  [[nodiscard]] const PinholeCamera& camera() const { return camera_; }

 private:
  struct Sums {
    double q = 0.0, uq = 0.0, vq = 0.0;
  };

  void halve(const cv::Mat1f& depth_m, float max_difference);
  void limitWindows(float max_step);
  void integrate();
  void fitPlanes();
  void measureCurvature();

  int width_ = 0, height_ = 0;
  PinholeCamera camera_;
  std::vector<float> inverse_depth_;
  std::vector<std::int8_t> radii_;  ///< of the largest window inside one surface; -1 without measurement
  std::vector<std::int8_t> breaks_;
  std::vector<Sums> sums_;  ///< integral image, one row and column more
  std::vector<SurfaceNormal> normals_;
  std::vector<cv::Vec2f> gradients_;
  std::vector<float> curvatures_;
};

}  // namespace saccade
