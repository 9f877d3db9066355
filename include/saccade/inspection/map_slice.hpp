#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

#include "saccade/map/map_cursor.hpp"

namespace saccade {

/// A plane across the map, at right angles to an axis of W.
struct SlicePlane {
  int axis = 2;       ///< 0 x, 1 y, 2 z
  double at_m = 0.0;  ///< where along the axis
};

/// What a cell of a slice is; of several leaves in one cell the one listed last here counts.
enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied, kAttended, kInhibited };
constexpr std::size_t kCellStates = 5;
/// "unknown", "free", "occupied", "attended" (remembered, but not inhibited) or "inhibited".
[[nodiscard]] const char* nameOf(CellState state);

/// The leaves that a plane cuts, as a picture.
///
/// Columns run along x (along z in a slice across x). Rows run along y, downwards as in the first camera's picture, and
/// in a slice across y along -z, so that it is a plan seen from above with what lies ahead at the top.
struct MapSlice {
  SlicePlane plane;
  double cell_m = 0.0;  ///< edge of a cell: a leaf, or a power of two of them where the slice is wider than kMostCells
  int column_axis = 0, row_axis = 1;
  double first_column_m = 0.0;  ///< outer edge of the first column
  double first_row_m = 0.0;     ///< outer edge of the first row
  double row_step_m = 0.0;      ///< from a row to the next; negative in a slice across y
  cv::Mat1b cells;              ///< CellState; without rows where the plane meets nothing known

  static constexpr int kMostCells = 4096;  ///< a side

  /// Cells of each state.
  [[nodiscard]] std::array<std::int64_t, kCellStates> counts() const;
};

/// Cuts the map. Throws std::invalid_argument for a plane that is not finite or lies outside the key space.
/// Cost: the nodes that the plane meets.
[[nodiscard]] MapSlice sliceMap(const MapTree& map, const SlicePlane& plane);

/// The slice with fewer cells, at most `most_columns` × `most_rows`, the cells joined as in CellState.
[[nodiscard]] cv::Mat1b shrinkCells(const cv::Mat1b& cells, int most_columns, int most_rows);

/// BGR, each cell a square of pixels so that the longer side has about 1000; inhibited cells are white as in the
/// paper's 2D IOR map.
[[nodiscard]] cv::Mat3b paintSlice(const MapSlice& slice);

}  // namespace saccade
