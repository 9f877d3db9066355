#pragma once

#include <opencv2/core.hpp>

namespace saccade {

/// A partition of an image into segments.
struct Segmentation {
  cv::Mat1i labels;  ///< 0 ... count - 1, numbered by first pixel in row order; -1 = in no segment (noise, no depth)
  int count = 0;
};

}  // namespace saccade
