#pragma once

#include <algorithm>

#include <opencv2/core.hpp>

namespace saccade {

/// Gives every pixel the value. cv::Mat::setTo does so too, but takes memory from the heap for it each time.
template <typename T>
void fillImage(cv::Mat_<T>& image, const T& value) {
  for (int v = 0; v < image.rows; ++v) std::fill_n(image[v], image.cols, value);
}

}  // namespace saccade
