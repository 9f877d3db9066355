#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/distorted_camera.hpp"

namespace saccade {

/// Takes images of the ideal camera C back to the pixels of the input's own colour image, nearest pixel by nearest
/// pixel: the inverse of what a source does when it removes lens distortion. Owns a table of 4 bytes a pixel.
class DistortedPixels {
 public:
  /// `ideal`: C; `real`: the input's own camera, of the same size. Images are the same where `real` has no distortion
  /// and is C. Throws std::invalid_argument on an empty camera or another size.
  DistortedPixels(const PinholeCamera& ideal, const DistortedCamera& real);
  /// For an input whose own camera is C.
  explicit DistortedPixels(const PinholeCamera& ideal) : DistortedPixels(ideal, {ideal, {}}) {}

  [[nodiscard]] bool areIdeal() const { return ideal_pixel_.empty(); }
  [[nodiscard]] cv::Size size() const { return size_; }

  /// Writes the input's view of `ideal` to `distorted`, which may not share its pixels; `outside` where the input sees
  /// what C does not. Throws std::invalid_argument for an image of another size.
  template <typename T>
  void distort(const cv::Mat_<T>& ideal, cv::Mat_<T>& distorted, T outside) const {
    requireSize(ideal.size());
    if (areIdeal()) {
      ideal.copyTo(distorted);
      return;
    }
    distorted.create(size_);
    for (int v = 0; v < size_.height; ++v) distortRow(ideal, v, distorted[v], outside);
  }

  /// Row `v` of the input's view alone: writes its pixels to `row`. Throws as distort() does.
  template <typename T>
  void distortRow(const cv::Mat_<T>& ideal, int v, T* row, T outside) const {
    requireSize(ideal.size());
    if (areIdeal()) {
      std::copy_n(ideal[v], size_.width, row);
      return;
    }
    const std::int32_t* from = ideal_pixel_.data() + static_cast<std::ptrdiff_t>(v) * size_.width;
    const auto stride = static_cast<std::ptrdiff_t>(ideal.step1());
    const T* pixels = ideal[0];
    if (stride == size_.width) {
      for (int u = 0; u < size_.width; ++u) row[u] = from[u] < 0 ? outside : pixels[from[u]];
    } else {
      for (int u = 0; u < size_.width; ++u) {
        row[u] = from[u] < 0 ? outside : pixels[from[u] / size_.width * stride + from[u] % size_.width];
      }
    }
  }

 private:
  void requireSize(const cv::Size& size) const;

  cv::Size size_;
  std::vector<std::int32_t> ideal_pixel_;  ///< of each pixel of the input: its position in C's image, or -1
};

}  // namespace saccade
