#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "saccade/exchange/ior_paint.hpp"
#include "saccade/map/ior_map.hpp"

/// The occupied leaves as a point cloud, and the files that hold one.
namespace saccade {

/// One occupied leaf as a point.
struct MapPoint {
  Eigen::Vector3f p_W;                               ///< centre of the leaf, metres
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< in W; (0, 0, 0) where none is known
  Rgb color{255, 255, 255};                          ///< white where none is known
  std::uint32_t ior_weight = 0;                      ///< ticks until attention forgets the leaf
  bool ior_flag = false;                             ///< whether it is inhibited
  float log_odds = 0.0f;
  float leaf_m = 0.0f;  ///< edge of the leaf; coarse leaves are one point
};

/// The occupied leaves in Morton order, painted; those that `wanted` refuses are left out.
[[nodiscard]] std::vector<MapPoint> occupiedPoints(const IorMap& map, LeafPaint paint = LeafPaint::kColor,
                                                   const std::function<bool(const MapLeaf&)>& wanted = {});

/// Binary PLY (little-endian) with position, normal, colour, `ior_weight`, `ior_flag`, `log_odds` and `leaf_m`.
void writePly(std::span<const MapPoint> points, std::ostream& out);

/// Binary PCD 0.7 with the same fields; colour packed as PCL's `rgb`, normals as `normal_x` ....
void writePcd(std::span<const MapPoint> points, std::ostream& out);

}  // namespace saccade
