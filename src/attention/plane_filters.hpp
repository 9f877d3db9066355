#pragma once

#include <vector>

namespace saccade {

/// A float image whose rows are padded to whole vectors; the padding holds finite numbers without meaning.
struct Plane {
  int width = 0;
  int height = 0;
  int stride = 0;
  std::vector<float> values;

  void resize(int new_width, int new_height);
  [[nodiscard]] float* row(int y) {
    return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(stride);
  }
  [[nodiscard]] const float* row(int y) const {
    return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(stride);
  }
};

/// Floats in one block of the filters' inner loops; rows are padded to it.
inline constexpr int kBlock = 32;

/// Half of a symmetric kernel, centre first, that sums to 1. Its variance is that of the Gaussian: the sampled and cut
/// Gaussian is narrower or wider by some percent at small sigmas, and the pyramids apply many in a row.
[[nodiscard]] std::vector<float> gaussianHalfKernel(double sigma);

/// Separable filters of the saliency pyramids; owns their row buffers. Borders are replicated.
class PlaneFilter {
 public:
  /// `out` = `in` convolved with the kernel in both directions. `out` must be another plane than `in`.
  void blur(const Plane& in, const std::vector<float>& half_kernel, Plane& out);

  /// `out` = means of 2 x 2 pixels of `in`; an odd last row or column is repeated.
  void halve(const Plane& in, Plane& out);

  /// Adds `in`, enlarged by two with cubic interpolation, to `out`, whose size must round up to twice that of `in`.
  /// Pixels are aligned as blocks (block centre to pixel centre), then the content is moved right and down by `shift`
  /// pixels of `in`, |shift| <= 1/4.
  void addEnlarged(const Plane& in, double shift, Plane& out);

 private:
  std::vector<float> row_;
};

/// sum += |a - b|, all of the same size.
void addAbsoluteDifference(const Plane& a, const Plane& b, Plane& sum);

}  // namespace saccade
