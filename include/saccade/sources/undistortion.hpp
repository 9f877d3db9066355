#pragma once

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/distorted_camera.hpp"

namespace saccade {

/// Removes the lens distortion of one camera from its images: the result is the image of an ideal pinhole camera, as
/// idealCameraOf() gives. Pixels that look past the edge of the distorted image repeat its edge, so that no frame of
/// another colour catches the eye; their label is 0.
///
/// Owns the fixed-point maps (6 bytes a pixel). Colour is interpolated, labels take the nearest pixel. Depth is not its
/// business: DepthRegistration handles the distortion of a depth camera.
class Undistortion {
 public:
  /// Both cameras are of one size. Makes a filter that only copies where `real` has no distortion and is `ideal`.
  /// Throws std::invalid_argument on an empty camera or different sizes.
  Undistortion(const PinholeCamera& ideal, const DistortedCamera& real);

  [[nodiscard]] bool isIdentity() const { return identity_; }

  /// Writes the ideal image of `distorted` (of the camera's size) to `ideal`, which may not share its pixels; the
  /// buffer is reused. About 1 ms for 640x480.
  void undistort(const cv::Mat3b& distorted, cv::Mat3b& ideal) const;
  void undistort(const cv::Mat1w& distorted_label, cv::Mat1w& ideal_label) const;

 private:
  void requireSize(const cv::Size& size) const;

  cv::Size size_;
  bool identity_ = true;
  cv::Mat positions_;  // CV_16SC2, whole part of the source pixel
  cv::Mat fractions_;  // CV_16UC1, index of the interpolation weights
  cv::Mat nearest_;    // CV_16SC2, rounded source pixel, for labels
};

}  // namespace saccade
