#include "map/working_depth.hpp"

#include <algorithm>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

SACCADE_MULTIVERSION void keepInRange(const float* depth_m, float* out, int n, float min_m, float max_m, float scale) {
  for (int i = 0; i < n; ++i) {
    const float d = depth_m[i];
    out[i] = (d >= min_m && d <= max_m) ? d * scale : 0.0f;  // false for NaN
  }
}

}  // namespace

void WorkingDepth::assign(const cv::Mat1f& depth_m, float min_m, float max_m, float scale) {
  width_ = depth_m.cols;
  height_ = depth_m.rows;
  values_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  const float lowest_m = std::max(min_m, 1e-6f);  // 0 is no measurement even with min_m = 0
  for (int v = 0; v < height_; ++v) {
    float* out = &values_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_)];
    keepInRange(depth_m[v], out, width_, lowest_m, max_m, scale);
  }
}

}  // namespace saccade
