#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

/// What happens to colour while the shutter of a hand-held camera is open: motion blur, a soft lens, the camera's
/// curve, and an exposure and white balance that drift slowly. Cameras differ from seed to seed. A pure function of the
/// seed, the frame and the images.
class Exposure {
 public:
  /// `strength` scales blur and drift; 0 leaves the images as they are.
  Exposure(std::uint64_t seed, double strength, const PinholeCamera& camera);

  /// `T_NC` takes points of this frame's camera C into the next frame's N: the motion whose share is blurred.
  void apply(std::int64_t frame, const cv::Mat1f& depth_m, const Pose& T_NC, cv::Mat3b& color);

 private:
  void blurBlock(const cv::Rect& block, const cv::Mat1f& depth_m, const Pose& T_NC, cv::Mat3b& color) const;

  double strength_;
  PinholeCamera camera_;
  double phase_[3];
  double open_share_;  ///< of the time between frames; the darker a room, the longer
  double lens_sigma_px_;
  double contrast_;  ///< slope of the curve about middle grey
  cv::Mat3b sharp_;
};

}  // namespace saccade
