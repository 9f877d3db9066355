#include "rendering/pixel_canvas.hpp"

#include "core/fill_image.hpp"

namespace saccade {

void PixelCanvas::reset(cv::Mat1f& inverse_depth, cv::Mat1i& leaf) {
  fillImage(inverse_depth, 0.0f);
  fillImage(leaf, -1);
  inverse_depth_ = inverse_depth[0];
  leaf_ = leaf[0];
  stride_ = leaf.cols;
  const int tiles_x = (leaf.cols + 7) / 8, tiles_y = (leaf.rows + 7) / 8;
  tile_stride_ = static_cast<std::size_t>(tiles_x) + 1;
  open_.assign(tile_stride_ * (static_cast<std::size_t>(tiles_y) + 1), 0);
  const PixelRect image{0, 0, leaf.cols - 1, leaf.rows - 1};
  for (int tile_y = 0; tile_y < tiles_y; ++tile_y) {
    for (int tile_x = 0; tile_x < tiles_x; ++tile_x) open_[index(tile_x, tile_y)] = tileBits(image, tile_x, tile_y);
  }
}

}  // namespace saccade
