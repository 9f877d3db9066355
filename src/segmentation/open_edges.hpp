#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "segmentation/color_edges.hpp"

namespace saccade {

/// Finds the edges between different components of an image that can still matter.
///
/// In a triangle with two corners in one component, its two other edges join the same pair of components. Only the
/// first of them, in the order of edges, can matter: either it joins the two, or one of them takes no edge any more.
/// Owns row buffers; goes through the image from top to bottom.
class OpenEdges {
 public:
  /// `components`: labels of the pixels, in rows of `stride`, which may be read up to ColorEdges::kPadding columns
  /// beyond their ends, the last one too.
  void begin(const ColorEdges& edges, const std::int32_t* components, std::ptrdiff_t stride);

  /// Moves on to the next row, the first time to row 0.
  void nextRow();

  /// Not 0 at the columns of the present row where an edge of the direction matters; only those of
  /// ColorEdges::columns() mean something.
  [[nodiscard]] const std::uint16_t* open(int direction) const {
    return open_[static_cast<std::size_t>(direction)].data();
  }

 private:
  using Rows = std::array<std::vector<std::uint16_t>, kEdgeDirections>;

  const ColorEdges* edges_ = nullptr;
  const std::int32_t* components_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  int row_ = -1;
  Rows different_;  ///< whether the ends' components differ
  Rows open_;
  std::vector<std::uint16_t> next_different_right_, next_open_right_;  ///< direction 0 of the next row
};

}  // namespace saccade
