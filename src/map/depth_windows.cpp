#include "map/depth_windows.hpp"

#include <algorithm>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

SACCADE_MULTIVERSION
void mergeMaxima(const float* a, const float* b, int count, float* out) {
  for (int i = 0; i < count; ++i) out[i] = a[i] > b[i] ? a[i] : b[i];
}

SACCADE_MULTIVERSION
void maximaOfCells(const float* row, int columns, float* out) {
  for (int i = 0; i < columns; ++i) {
    const float* in = row + DepthWindows::kCellPixels * i;
    const float first = in[0] > in[1] ? in[0] : in[1], second = in[2] > in[3] ? in[2] : in[3];
    out[i] = first > second ? first : second;
  }
}

}  // namespace

void DepthWindows::build(const cv::Mat1f& depth_m) {
  static_assert(kCellPixels == 4);
  const int columns = (depth_m.cols + kCellPixels - 1) / kCellPixels;
  const int rows = (depth_m.rows + kCellPixels - 1) / kCellPixels;
  const auto size = static_cast<std::size_t>(columns * rows);
  constexpr std::size_t kLevels = kRadii.size() + 1;
  farthest_.resize((kLevels + 2) * size);  // two images for what lies between two levels
  float* const cells = farthest_.data() + kLevels * size;
  float* const widened = cells + size;
  const int margin = kRadii.back();
  row_.assign(static_cast<std::size_t>(std::max(columns * kCellPixels, columns + 2 * margin)), 0.0F);

  for (int row = 0; row < rows; ++row) {
    const int first = row * kCellPixels;
    std::copy_n(depth_m[first], depth_m.cols, row_.data());
    for (int v = first + 1; v < std::min(first + kCellPixels, depth_m.rows); ++v) {
      mergeMaxima(row_.data(), depth_m[v], depth_m.cols, row_.data());
    }
    maximaOfCells(row_.data(), columns, cells + row * columns);
  }

  // A window is the union of two smaller ones, or of three at first; at the image's edge they are moved inwards.
  const float* in = cells;
  int before = 0;
  float* out = farthest_.data();
  for (const int radius : kRadii) {
    const int shift = radius - before;
    float* const padded = row_.data();
    for (int row = 0; row < rows; ++row) {
      const float* line = in + row * columns;
      std::fill_n(padded, shift, line[0]);
      std::copy_n(line, columns, padded + shift);
      std::fill_n(padded + shift + columns, shift, line[columns - 1]);
      mergeMaxima(padded, padded + 2 * shift, columns, widened + row * columns);
      if (before == 0) mergeMaxima(line, widened + row * columns, columns, widened + row * columns);
    }
    for (int row = 0; row < rows; ++row) {
      mergeMaxima(widened + std::max(row - shift, 0) * columns, widened + std::min(row + shift, rows - 1) * columns,
                  columns, out + row * columns);
      if (before == 0) mergeMaxima(widened + row * columns, out + row * columns, columns, out + row * columns);
    }
    in = out;
    before = radius;
    out += size;
  }
  std::fill_n(out, size, size > 0 ? *std::max_element(cells, cells + size) : 0.0F);

  table_ = {farthest_.data(), columns, rows, {}};
  std::size_t level = 0;
  for (std::size_t radius = 0; radius < table_.levels.size(); ++radius) {
    if (level < kRadii.size() && static_cast<int>(radius) > kRadii[level]) ++level;
    table_.levels[radius] = static_cast<std::int32_t>(level * size);
  }
}

}  // namespace saccade
