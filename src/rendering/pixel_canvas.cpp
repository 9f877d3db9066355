#include "rendering/pixel_canvas.hpp"

#include <utility>

namespace saccade {

void PixelCanvas::reset(cv::Mat1f inverse_depth, cv::Mat1i leaf) {
  inverse_depth_ = std::move(inverse_depth);
  leaf_ = std::move(leaf);
  inverse_depth_.setTo(0.0f);
  leaf_.setTo(-1);
  const int tiles_x = (leaf_.cols + 7) / 8, tiles_y = (leaf_.rows + 7) / 8;
  stride_ = static_cast<std::size_t>(tiles_x) + 1;
  open_.assign(stride_ * (static_cast<std::size_t>(tiles_y) + 1), 0);
  const PixelRect image{0, 0, leaf_.cols - 1, leaf_.rows - 1};
  for (int tile_y = 0; tile_y < tiles_y; ++tile_y) {
    for (int tile_x = 0; tile_x < tiles_x; ++tile_x) open_[index(tile_x, tile_y)] = tileBits(image, tile_x, tile_y);
  }
}

}  // namespace saccade
