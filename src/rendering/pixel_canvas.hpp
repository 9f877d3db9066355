#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// Pixels of a rectangle, all ends included.
struct PixelRect {
  int first_u = 0, first_v = 0, last_u = -1, last_v = -1;
};

/// Two images, what each pixel sees so far, and which pixels are open: see nothing yet.
///
/// As leaves come front to back a pixel is written once. The open pixels are held as bits, one word per tile of 8×8
/// pixels (row by row, columns from the lowest bit), so that a few operations on words answer for a whole leaf. A
/// *window* is 8×8 pixels anywhere in the image, in the same order of bits; it may hang over the right and lower
/// border, where no pixel is open.
class PixelCanvas {
 public:
  /// Takes continuous images of one size to draw on, which must outlive it, and clears them: all pixels open.
  void reset(cv::Mat1f& inverse_depth, cv::Mat1i& leaf);

  /// Pixel (u, v) of the images: 1 / depth in 1 / leaves (0 = hole), position in the list of leaves (-1).
  [[nodiscard]] float* inverseDepth(int u, int v) { return inverse_depth_ + v * stride_ + u; }
  [[nodiscard]] std::int32_t* leaf(int u, int v) { return leaf_ + v * stride_ + u; }
  /// From a pixel to the one below it, in elements of either image.
  [[nodiscard]] std::ptrdiff_t stride() const { return stride_; }

  /// The open pixels of the window at (u, v).
  [[nodiscard]] std::uint64_t openInWindow(int u, int v) const {
    const std::uint64_t* const tile = &open_[index(u >> 3, v >> 3)];
    const int right = u & 7, down = 8 * (v & 7);
    const std::uint64_t left_part = join(tile[0], tile[tile_stride_], down);
    const std::uint64_t right_part = join(tile[1], tile[tile_stride_ + 1], down);
    const std::uint64_t left_columns = kEveryRow * (0xFFull >> right);
    return ((left_part >> right) & left_columns) | ((right_part << (8 - right)) & ~left_columns);
  }
  /// Closes pixels of the window at (u, v), which must be open.
  void closeInWindow(int u, int v, std::uint64_t pixels) {
    std::uint64_t* const tile = &open_[index(u >> 3, v >> 3)];
    const int right = u & 7, down = 8 * (v & 7);
    const std::uint64_t left_columns = kEveryRow * (0xFFull >> right);
    const std::uint64_t left_part = (pixels & left_columns) << right;
    const std::uint64_t right_part = (pixels & ~left_columns) >> (8 - right);
    tile[0] ^= left_part << down;
    tile[1] ^= right_part << down;
    tile[tile_stride_] ^= (left_part >> 8) >> (56 - down);
    tile[tile_stride_ + 1] ^= (right_part >> 8) >> (56 - down);
  }
  /// Whether a pixel of `rect`, which must lie in the image, is open.
  [[nodiscard]] bool isOpen(const PixelRect& rect) const {
    for (int tile_y = rect.first_v >> 3; tile_y <= rect.last_v >> 3; ++tile_y) {
      for (int tile_x = rect.first_u >> 3; tile_x <= rect.last_u >> 3; ++tile_x) {
        if ((open_[index(tile_x, tile_y)] & tileBits(rect, tile_x, tile_y)) != 0) return true;
      }
    }
    return false;
  }
  /// The pixels of the window at (u, v), which must be in `rect`, that are in `rect`.
  [[nodiscard]] static std::uint64_t windowBits(const PixelRect& rect, int u, int v) {
    const int columns = rect.last_u - u < 7 ? rect.last_u - u : 7;
    const int rows = rect.last_v - v < 7 ? rect.last_v - v : 7;
    return kEveryRow * (0xFFull >> (7 - columns)) & ~0ull >> 8 * (7 - rows);
  }

 private:
  static constexpr std::uint64_t kEveryRow = 0x0101010101010101ull;

  [[nodiscard]] static std::uint64_t join(std::uint64_t upper, std::uint64_t lower, int down) {
    return upper >> down | (lower << 8) << (56 - down);
  }
  [[nodiscard]] static std::uint64_t tileBits(const PixelRect& rect, int tile_x, int tile_y) {
    const int left = rect.first_u > 8 * tile_x ? rect.first_u & 7 : 0;
    const int right = rect.last_u < 8 * tile_x + 7 ? rect.last_u & 7 : 7;
    const int top = rect.first_v > 8 * tile_y ? rect.first_v & 7 : 0;
    const int bottom = rect.last_v < 8 * tile_y + 7 ? rect.last_v & 7 : 7;
    return kEveryRow * ((0xFFull >> (7 - right + left)) << left) & (~0ull >> 8 * (7 - bottom + top)) << 8 * top;
  }
  [[nodiscard]] std::size_t index(int tile_x, int tile_y) const {
    return static_cast<std::size_t>(tile_y) * tile_stride_ + static_cast<std::size_t>(tile_x);
  }

  float* inverse_depth_ = nullptr;
  std::int32_t* leaf_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  std::vector<std::uint64_t> open_;  ///< with one more row and column of tiles, never open
  std::size_t tile_stride_ = 0;
};

}  // namespace saccade
