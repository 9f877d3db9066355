#include "saccade/core/distorted_camera.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace saccade {
namespace {

/// Smallest and largest ideal coordinate of an image's pixels along one axis.
struct Extent {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Focal length at which the extent fills `pixels`.
  [[nodiscard]] double focal(int pixels) const { return (pixels - 1) / (high - low); }
};

}  // namespace

PinholeCamera idealCameraOf(const DistortedCamera& real) {
  const PinholeCamera& camera = real.camera;
  if (camera.width < 2 || camera.height < 2 || !(camera.fx > 0) || !(camera.fy > 0)) {
    throw std::invalid_argument("idealCameraOf: expected a camera with a size and focal lengths, found " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  if (real.distortion.isZero()) return camera;
  Extent x_extent, y_extent;
  const auto add = [&](int u, int v) {
    const auto [x, y] = real.distortion.undistort((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
    x_extent.add(x);
    y_extent.add(y);
  };
  for (int u = 0; u < camera.width; ++u) {  // distortion keeps the border outside of all else
    add(u, 0);
    add(u, camera.height - 1);
  }
  for (int v = 0; v < camera.height; ++v) {
    add(0, v);
    add(camera.width - 1, v);
  }
  const double scale = std::min(x_extent.focal(camera.width) / camera.fx, y_extent.focal(camera.height) / camera.fy);
  const bool sees_all = scale >= 1.0 && x_extent.low * camera.fx + camera.cx >= 0 &&
                        x_extent.high * camera.fx + camera.cx <= camera.width - 1 &&
                        y_extent.low * camera.fy + camera.cy >= 0 &&
                        y_extent.high * camera.fy + camera.cy <= camera.height - 1;
  if (sees_all) return camera;
  PinholeCamera ideal = camera;
  ideal.fx *= std::min(scale, 1.0);
  ideal.fy *= std::min(scale, 1.0);
  ideal.cx = (camera.width - 1 - (x_extent.low + x_extent.high) * ideal.fx) / 2.0;
  ideal.cy = (camera.height - 1 - (y_extent.low + y_extent.high) * ideal.fy) / 2.0;
  return ideal;
}

}  // namespace saccade
