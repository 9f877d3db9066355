#pragma once

#include <array>
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

  /// `out` = every other pixel of `in`, beginning with the first, smoothed with (1/4, 1/2, 1/4) in both directions.
  void halve(const Plane& in, Plane& out);

  /// Row `y` of `in` enlarged by two with cubic interpolation, `columns` pixels, whose number must round up to twice
  /// the width of `in`. Pixel 2i lies on pixel i, then the content is moved right and down by `shift` pixels of `in`,
  /// 0 <= shift <= 1/2.
  void enlargeOneRow(const Plane& in, double shift, int y, int columns, float* out);

  /// Adds `in` to `sum`, enlarged like that, or only moved if `sum` is of the same size.
  void addResampled(const Plane& in, double shift, Plane& sum);

  /// sum += |center - surround|. The surround is of the same size, or halved and then interpolated.
  void addContrast(const Plane& center, const Plane& surround, Plane& sum);

 private:
  void blurOneRow(const Plane& in, const std::vector<float>& half_kernel, int y, float* out);
  void addContrastFromHalf(const float* center, const Plane& surround, int y, int columns, float* sum);
  float* interpolateRow(const Plane& in, const std::array<float, 4>& weights, int first);
  [[nodiscard]] float* rowWithMargin(int columns, int margin);

  std::vector<float> row_, added_row_;
};

}  // namespace saccade
