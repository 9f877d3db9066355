#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace saccade {

/// A texture and its halved copies, so that a pixel that covers many texels sees their mean. Repeats beyond its edges.
class Mipmap {
 public:
  explicit Mipmap(const cv::Mat3b& image);

  [[nodiscard]] cv::Size size() const { return levels_.front().size(); }
  /// BGR at texture coordinates (1 = the whole image), averaged over about `texels` texels of the finest level.
  [[nodiscard]] Eigen::Array3f sample(const Eigen::Vector2f& uv, float texels) const;

 private:
  std::vector<cv::Mat3b> levels_;
};

}  // namespace saccade
