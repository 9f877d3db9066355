#include "saccade/inspection/scene_frame.hpp"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "inspection/leaf_walk.hpp"
#include "saccade/inspection/up_direction.hpp"

namespace saccade {
namespace {

constexpr double kStrayShare = 0.002;  ///< of the leaves at either end of an axis that the extent leaves out

/// The part of one axis that holds all but the outermost leaves at either end, as keys; `counts` by key.
std::pair<int, int> extentOf(const std::vector<std::int64_t>& counts, std::int64_t total) {
  const auto stray = static_cast<std::int64_t>(kStrayShare * static_cast<double>(total));
  int low = 0, high = static_cast<int>(counts.size()) - 1;
  for (std::int64_t passed = 0; (passed += counts[static_cast<std::size_t>(low)]) <= stray;) ++low;
  for (std::int64_t passed = 0; (passed += counts[static_cast<std::size_t>(high)]) <= stray;) --high;
  return {low, high + 1};
}

}  // namespace

SceneFrame findSceneFrame(const MapTree& map, std::span<const FrameRecord> frames) {
  SceneFrame scene;
  scene.up_W = estimateUp(map, frames);
  std::array<std::vector<std::int64_t>, 3> counts;
  for (auto& axis : counts) axis.assign(2 * MapTree::kCentreKey, 0);
  std::int64_t total = 0;
  forEachOccupiedLeaf(map, [&](const NodeKey& key, MapNode) {
    const int edge = 1 << (MapTree::kDepth - key.depth);
    const std::array<int, 3> corner = {key.corner.x, key.corner.y, key.corner.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < edge; ++i) counts[axis][static_cast<std::size_t>(corner[axis] + i)] += edge * edge;
    }
    total += std::int64_t{edge} * edge * edge;
  });
  if (total == 0) return scene;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = extentOf(counts[axis], total);
    scene.box.min()[static_cast<Eigen::Index>(axis)] = (low - MapTree::kCentreKey) * map.leaf_size_m;
    scene.box.max()[static_cast<Eigen::Index>(axis)] = (high - MapTree::kCentreKey) * map.leaf_size_m;
  }
  return scene;
}

}  // namespace saccade
