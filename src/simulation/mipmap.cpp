#include "simulation/mipmap.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

int wrapped(int index, int size) {
  const int rest = index % size;
  return rest < 0 ? rest + size : rest;
}

Eigen::Array3f texel(const cv::Vec3b& bgr) {
  return {static_cast<float>(bgr[0]), static_cast<float>(bgr[1]), static_cast<float>(bgr[2])};
}

}  // namespace

Mipmap::Mipmap(const cv::Mat3b& image) {
  levels_.push_back(image);
  while (std::min(levels_.back().cols, levels_.back().rows) >= 4) {
    cv::Mat3b half;
    cv::resize(levels_.back(), half, cv::Size(levels_.back().cols / 2, levels_.back().rows / 2), 0, 0, cv::INTER_AREA);
    levels_.push_back(half);
  }
}

Eigen::Array3f Mipmap::sample(const Eigen::Vector2f& uv, float texels) const {
  constexpr float kHalfway = 1.41421356f;  // between two levels
  const int halvings = std::ilogb(std::max(kHalfway * texels, 1.0f));
  const cv::Mat3b& level = levels_[std::min(static_cast<std::size_t>(halvings), levels_.size() - 1)];
  const float x = uv.x() * static_cast<float>(level.cols) - 0.5f, y = uv.y() * static_cast<float>(level.rows) - 0.5f;
  const float x0 = std::floor(x), y0 = std::floor(y), s = x - x0, t = y - y0;
  const int column = wrapped(static_cast<int>(x0), level.cols), row = wrapped(static_cast<int>(y0), level.rows);
  const int right = column + 1 == level.cols ? 0 : column + 1, below = row + 1 == level.rows ? 0 : row + 1;
  const cv::Vec3b *upper = level[row], *lower = level[below];
  return (1 - t) * ((1 - s) * texel(upper[column]) + s * texel(upper[right])) +
         t * ((1 - s) * texel(lower[column]) + s * texel(lower[right]));
}

}  // namespace saccade
