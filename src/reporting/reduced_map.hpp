#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "saccade/map/map_cursor.hpp"

namespace saccade {

/// The occupied part of a map in few points, packed for a page's script.
///
/// A point is 14 bytes, little-endian: x, y, z of its centre (uint16, in halves of a cell from `origin_W`), red, green,
/// blue, attention (bits 0-6: IOR weight in 1/127 of `largest_weight`, rounded up; bit 7: inhibited), the normal's x
/// and y in octahedral form (int8; both -128: none), log2 of its edge in cells, 0.
struct ReducedMap {
  static constexpr std::size_t kPointBytes = 14;

  double cell_m = 0.0;  ///< edge of a cell
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();
  std::uint32_t largest_weight = 0;  ///< ticks
  std::vector<std::uint8_t> bytes;

  [[nodiscard]] std::size_t pointCount() const { return bytes.size() / kPointBytes; }
};

/// Joins leaves to the finest cells with which the map has at most `most_points`: mean colour and normal of the
/// occupied leaves within, the largest IOR weight, inhibited if any is. Coarser leaves than a cell stay one point.
/// Cost: every occupied leaf, twice.
[[nodiscard]] ReducedMap reduceMap(const MapTree& map, std::size_t most_points);

}  // namespace saccade
