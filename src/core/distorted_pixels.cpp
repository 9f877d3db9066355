#include "saccade/core/distorted_pixels.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace saccade {
namespace {

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

}  // namespace

DistortedPixels::DistortedPixels(const PinholeCamera& ideal, const DistortedCamera& real)
    : size_(ideal.width, ideal.height) {
  const PinholeCamera& camera = real.camera;
  if (camera.width <= 0 || camera.height <= 0 || !(camera.fx > 0) || !(camera.fy > 0)) {
    throw std::invalid_argument("DistortedPixels: expected a camera with a size and focal lengths, found " +
                                sizeText({camera.width, camera.height}));
  }
  requireSize({camera.width, camera.height});
  if (real.distortion.isZero() && camera == ideal) return;
  ideal_pixel_.reserve(static_cast<std::size_t>(size_.area()));
  for (int v = 0; v < size_.height; ++v) {
    for (int u = 0; u < size_.width; ++u) {
      const auto [x, y] = real.distortion.undistort((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      const double ideal_u = std::round(ideal.fx * x + ideal.cx), ideal_v = std::round(ideal.fy * y + ideal.cy);
      const bool inside = ideal_u >= 0 && ideal_u < size_.width && ideal_v >= 0 && ideal_v < size_.height;
      ideal_pixel_.push_back(inside ? static_cast<std::int32_t>(ideal_v) * size_.width + static_cast<int>(ideal_u)
                                    : -1);
    }
  }
}

void DistortedPixels::requireSize(const cv::Size& size) const {
  if (size == size_) return;
  throw std::invalid_argument("DistortedPixels: expected images of " + sizeText(size_) + ", found " + sizeText(size));
}

}  // namespace saccade
