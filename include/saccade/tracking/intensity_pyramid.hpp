#pragma once

#include <array>
#include <cstddef>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"

namespace saccade {

/// Grey values of a frame at a half and a quarter of its resolution: what photometric alignment compares.
struct IntensityPyramid {
  static constexpr std::size_t kLevels = 2;
  struct Level {
    PinholeCamera camera;
    cv::Mat1f grey;  ///< 0 to 255, means over the pixels of the colour image; of the camera's size
  };
  std::array<Level, kLevels> levels;  ///< a half first
  cv::Mat1b full;                     ///< grey values of the colour image itself

  /// Fills the levels from a colour image (BGR) of the size of `camera`. Reuses their buffers.
  void build(const cv::Mat3b& color, const PinholeCamera& camera);
};

}  // namespace saccade
