#include "saccade/inspection/map_slice.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "inspection/leaf_walk.hpp"

namespace saccade {
namespace {

/// A leaf that the plane cuts.
struct CutLeaf {
  NodeKey key;
  CellState state;
};

CellState stateOf(MapNode leaf, const MapTree& map) {
  if (leaf.logOdds() < map.occupied_log_odds) return CellState::kFree;
  if (inhibited(leaf.ior(), map.now)) return CellState::kInhibited;
  return weight(leaf.ior(), map.now) > 0 ? CellState::kAttended : CellState::kOccupied;
}

int along(const LeafKey& key, int axis) {
  return axis == 0 ? key.x : axis == 1 ? key.y : key.z;
}

int edgeOf(const NodeKey& key) {
  return 1 << (MapTree::kDepth - key.depth);
}

void collectBelow(const MapTree& map, MapNode node, const NodeKey& key, int axis, int plane_key,
                  std::vector<CutLeaf>& cut) {
  const int low = along(key.corner, axis);
  if (plane_key < low || plane_key >= low + edgeOf(key)) return;
  if (node.isLeaf()) {
    cut.push_back({key, stateOf(node, map)});
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    if ((node.childMask() >> i & 1u) != 0) collectBelow(map, node.child(i), childOf(key, i), axis, plane_key, cut);
  }
}

struct KeyRange {
  int low = 2 * MapTree::kCentreKey, high = 0;  ///< high is not in it
  [[nodiscard]] int size() const { return std::max(0, high - low); }
};

KeyRange rangeAlong(const std::vector<CutLeaf>& cut, int axis) {
  KeyRange range;
  for (const CutLeaf& leaf : cut) {
    const int low = along(leaf.key.corner, axis);
    range.low = std::min(range.low, low);
    range.high = std::max(range.high, low + edgeOf(leaf.key));
  }
  return range;
}

int keyOf(const MapTree& map, const SlicePlane& plane) {
  const double key = std::floor(plane.at_m / map.leaf_size_m) + MapTree::kCentreKey;
  if (!(key >= 0.0 && key < 2.0 * MapTree::kCentreKey)) {
    const double reach_m = MapTree::kCentreKey * map.leaf_size_m;
    throw std::invalid_argument(
        fmt::format("slice: expected a coordinate within {:g} m of the origin, found {}", reach_m, plane.at_m));
  }
  return static_cast<int>(key);
}

}  // namespace

const char* nameOf(CellState state) {
  constexpr std::array<const char*, kCellStates> kNames = {"unknown", "free", "occupied", "attended", "inhibited"};
  return kNames[static_cast<std::size_t>(state)];
}

std::array<std::int64_t, kCellStates> MapSlice::counts() const {
  std::array<std::int64_t, kCellStates> counts{};
  for (const std::uint8_t cell : cells) ++counts[cell];
  return counts;
}

MapSlice sliceMap(const MapTree& map, const SlicePlane& plane) {
  const int plane_key = keyOf(map, plane);
  MapSlice slice;
  slice.plane = plane;
  slice.column_axis = plane.axis == 0 ? 2 : 0;
  slice.row_axis = plane.axis == 1 ? 2 : 1;
  std::vector<CutLeaf> cut;
  if (map.root) collectBelow(map, map.root, NodeKey{}, plane.axis, plane_key, cut);
  const KeyRange columns = rangeAlong(cut, slice.column_axis), rows = rangeAlong(cut, slice.row_axis);
  int cell = 1;  // finest leaves along a cell's edge
  while (std::max(columns.size(), rows.size()) / cell >= MapSlice::kMostCells) cell *= 2;
  const auto cellOf = [&](int key, const KeyRange& range) { return (key - range.low) / cell; };
  slice.cell_m = map.leaf_size_m * cell;
  if (cut.empty()) return slice;
  slice.cells = cv::Mat1b(cellOf(rows.high - 1, rows) + 1, cellOf(columns.high - 1, columns) + 1,
                          static_cast<std::uint8_t>(CellState::kUnknown));
  for (const CutLeaf& leaf : cut) {
    const int u = along(leaf.key.corner, slice.column_axis), v = along(leaf.key.corner, slice.row_axis);
    const cv::Point first(cellOf(u, columns), cellOf(v, rows));
    const cv::Point last(cellOf(u + edgeOf(leaf.key) - 1, columns), cellOf(v + edgeOf(leaf.key) - 1, rows));
    cv::Mat1b covered = slice.cells(cv::Rect(first, last + cv::Point(1, 1)));
    cv::max(covered, static_cast<double>(leaf.state), covered);
  }
  const auto metres = [&](int key) { return (key - MapTree::kCentreKey) * map.leaf_size_m; };
  slice.first_column_m = metres(columns.low);
  slice.first_row_m = metres(rows.low);
  slice.row_step_m = slice.cell_m;
  if (plane.axis == 1) {
    cv::flip(slice.cells, slice.cells, 0);
    slice.first_row_m += slice.cell_m * slice.cells.rows;
    slice.row_step_m = -slice.cell_m;
  }
  return slice;
}

cv::Mat1b shrinkCells(const cv::Mat1b& cells, int most_columns, int most_rows) {
  if (cells.empty()) return cells;
  const cv::Size size(std::min(cells.cols, most_columns), std::min(cells.rows, most_rows));
  cv::Mat1b small(size, static_cast<std::uint8_t>(CellState::kUnknown));
  for (int v = 0; v < cells.rows; ++v) {
    for (int u = 0; u < cells.cols; ++u) {
      std::uint8_t& cell = small(v * size.height / cells.rows, u * size.width / cells.cols);
      cell = std::max(cell, cells(v, u));
    }
  }
  return small;
}

cv::Mat3b paintSlice(const MapSlice& slice) {
  constexpr int kLongerSide_px = 1000;
  const std::array<cv::Vec3b, kCellStates> colours = {
      {{32, 26, 24}, {78, 68, 62}, {196, 170, 140}, {60, 140, 235}, {255, 255, 255}}};
  if (slice.cells.empty()) return cv::Mat3b(kLongerSide_px / 4, kLongerSide_px / 4, colours[0]);
  cv::Mat3b picture(slice.cells.size());
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) picture(v, u) = colours[slice.cells(v, u)];
  }
  const int scale = std::max(1, kLongerSide_px / std::max(picture.cols, picture.rows));
  cv::resize(picture, picture, {}, scale, scale, cv::INTER_NEAREST);
  return picture;
}

}  // namespace saccade
