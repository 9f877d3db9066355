#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// Depth image in leaves, limited to the working range; 0 = no measurement.
class WorkingDepth {
 public:
  /// Keeps depths within [min_m, max_m], times `scale`; all else (0, NaN, infinite) becomes 0.
  void assign(const cv::Mat1f& depth_m, float min_m, float max_m, float scale);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const float* row(int v) const {
    return &values_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_)];
  }

 private:
  int width_ = 0, height_ = 0;
  std::vector<float> values_;
};

}  // namespace saccade
