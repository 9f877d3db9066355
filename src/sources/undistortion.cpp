#include "saccade/sources/undistortion.hpp"

#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

namespace saccade {

Undistortion::Undistortion(const PinholeCamera& ideal, const DistortedCamera& real)
    : size_(ideal.width, ideal.height), identity_(real.distortion.isZero() && real.camera == ideal) {
  const PinholeCamera& camera = real.camera;
  if (camera.width <= 0 || camera.height <= 0 || !(camera.fx > 0) || !(camera.fy > 0)) {
    throw std::invalid_argument("Undistortion: expected a camera with a size and focal lengths, found " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  requireSize({camera.width, camera.height});
  if (identity_) return;
  cv::Mat1f map_u(size_), map_v(size_);
  for (int v = 0; v < size_.height; ++v) {
    for (int u = 0; u < size_.width; ++u) {
      const auto [x, y] = real.distortion.distort((u - ideal.cx) / ideal.fx, (v - ideal.cy) / ideal.fy);
      map_u(v, u) = static_cast<float>(camera.fx * x + camera.cx);
      map_v(v, u) = static_cast<float>(camera.fy * y + camera.cy);
    }
  }
  cv::Mat none;
  cv::convertMaps(map_u, map_v, positions_, fractions_, CV_16SC2);
  cv::convertMaps(map_u, map_v, nearest_, none, CV_16SC2, true);
}

void Undistortion::requireSize(const cv::Size& size) const {
  if (size == size_) return;
  throw std::invalid_argument("Undistortion: expected images of " + std::to_string(size_.width) + " x " +
                              std::to_string(size_.height) + ", found " + std::to_string(size.width) + " x " +
                              std::to_string(size.height));
}

void Undistortion::undistort(const cv::Mat3b& distorted, cv::Mat3b& ideal) const {
  requireSize(distorted.size());
  if (identity_) {
    distorted.copyTo(ideal);
  } else {
    cv::remap(distorted, ideal, positions_, fractions_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  }
}

void Undistortion::undistort(const cv::Mat1w& distorted_label, cv::Mat1w& ideal_label) const {
  requireSize(distorted_label.size());
  if (identity_) {
    distorted_label.copyTo(ideal_label);
  } else {
    cv::remap(distorted_label, ideal_label, nearest_, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  }
}

}  // namespace saccade
