#include "saccade/tracking/intensity_pyramid.hpp"

#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

// Means over two by two pixels; an odd last row or column is left out, as PinholeCamera::reducedBy does.
template <typename Pixel>
void halve(const cv::Mat_<Pixel>& from, cv::Mat1f& to) {
  to.create(from.rows / 2, from.cols / 2);
  for (int v = 0; v < to.rows; ++v) {
    const Pixel* upper = from[2 * v];
    const Pixel* lower = from[2 * v + 1];
    float* mean = to[v];
    for (int u = 0; u < to.cols; ++u) {
      const auto sum = upper[2 * u] + upper[2 * u + 1] + lower[2 * u] + lower[2 * u + 1];
      mean[u] = 0.25F * static_cast<float>(sum);
    }
  }
}

}  // namespace

void IntensityPyramid::build(const cv::Mat3b& color, const PinholeCamera& camera) {
  cv::cvtColor(color, full, cv::COLOR_BGR2GRAY);
  halve(full, levels[0].grey);
  halve(levels[0].grey, levels[1].grey);
  levels[0].camera = camera.reducedBy(2);
  levels[1].camera = camera.reducedBy(4);
}

}  // namespace saccade
