#pragma once

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/sources/camera_calibration.hpp"

namespace saccade {

/// Removes the lens distortion of one camera from its images: the result is an ideal pinhole image with the same
/// intrinsics. Pixels that look past the edge of the distorted image are black (label 0).
///
/// Owns the fixed-point maps (6 bytes a pixel). Colour is interpolated, labels take the nearest pixel. Depth is not its
/// business: DepthRegistration handles the distortion of a depth camera.
class Undistortion {
 public:
  /// Makes a filter that only copies where `distortion` is zero. Throws std::invalid_argument on an empty camera.
  Undistortion(const PinholeCamera& camera, const LensDistortion& distortion);

  [[nodiscard]] bool isIdentity() const { return identity_; }

  /// Writes the ideal image of `distorted` (of the camera's size) to `ideal`, which may not share its pixels; the
  /// buffer is reused. About 1 ms for 640x480.
  void undistort(const cv::Mat3b& distorted, cv::Mat3b& ideal) const;
  void undistort(const cv::Mat1w& distorted_label, cv::Mat1w& ideal_label) const;

 private:
  void requireSize(const cv::Mat& image) const;

  cv::Size size_;
  bool identity_ = true;
  cv::Mat positions_;  // CV_16SC2, whole part of the source pixel
  cv::Mat fractions_;  // CV_16UC1, index of the interpolation weights
  cv::Mat nearest_;    // CV_16SC2, rounded source pixel, for labels
};

}  // namespace saccade
