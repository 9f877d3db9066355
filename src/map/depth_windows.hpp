#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "core/lanes.hpp"

namespace saccade {

/// How far a depth image reaches around any pixel: the largest depth of windows of several sizes around each small cell
/// of the image, so that one look bounds everything that a box in space can project onto.
class DepthWindows {
 public:
  static constexpr int kCellPixels = 4;

  /// Takes the depths (metres, 0 where nothing is measured) of an image. Cost: one pass over it, and little more.
  void build(const cv::Mat1f& depth_m);

  /// What find() needs, for kernels that are not members.
  struct Table {
    const float* farthest;                ///< by level, row and column
    int columns, rows;                    ///< cells
    std::array<std::int32_t, 22> levels;  ///< by window radius in cells: where in `farthest` the level starts
  };
  [[nodiscard]] const Table& table() const { return table_; }

 private:
  static constexpr std::array<int, 7> kRadii = {1, 2, 3, 4, 6, 10, 20};  // cells; a last level holds the whole image

  std::vector<float> farthest_;
  std::vector<float> row_;
  Table table_{};
};

/// Per lane the largest depth within `reach_u` columns and `reach_v` rows of pixel (u, v), or of a somewhat larger
/// window; 0 where nothing is measured. The pixel may lie outside of the image, but must fit an int.
SACCADE_INLINE FloatLanes farthestAround(const DepthWindows::Table& table, const FloatLanes& u, const FloatLanes& v,
                                         const FloatLanes& reach_u, const FloatLanes& reach_v) {
  constexpr float kPerCell = 1.0F / DepthWindows::kCellPixels;
  const FloatLanes zero = {};
  const FloatLanes last = allLanes(static_cast<float>(table.levels.size() - 1));
  const IntLanes radius = truncated(least(most(reach_u, reach_v) * kPerCell + 1.0F, last));
  const FloatLanes last_column = allLanes(static_cast<float>(table.columns - 1));
  const FloatLanes last_row = allLanes(static_cast<float>(table.rows - 1));
  const IntLanes column = truncated(least(most(u * kPerCell, zero), last_column));
  const IntLanes row = truncated(least(most(v * kPerCell, zero), last_row));
  const IntLanes cell = row * table.columns + column;
  FloatLanes found;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    found[lane] = table.farthest[table.levels[static_cast<std::size_t>(radius[lane])] + cell[lane]];
  }
  return found;
}

}  // namespace saccade
