#pragma once

#include <Eigen/Core>

#include "saccade/map/leaf_key.hpp"
#include "saccade/map/map_cursor.hpp"

/// Walks over the occupied part of a map, for everything that shows it.
namespace saccade {

/// Key of child `i` of the node `key`, which must not be at the finest depth.
[[nodiscard]] inline NodeKey childOf(const NodeKey& key, unsigned i) {
  const int bit = MapTree::kDepth - 1 - key.depth;
  return {{static_cast<std::uint16_t>(key.corner.x | (i & 1u) << bit),
           static_cast<std::uint16_t>(key.corner.y | (i >> 1 & 1u) << bit),
           static_cast<std::uint16_t>(key.corner.z | (i >> 2) << bit)},
          key.depth + 1};
}

/// Lowest corner of a node, frame W, metres.
[[nodiscard]] inline Eigen::Vector3d cornerOf(const NodeKey& key, const MapTree& map) {
  return (Eigen::Vector3d(key.corner.x, key.corner.y, key.corner.z).array() - MapTree::kCentreKey) * map.leaf_size_m;
}

/// Calls `visit(NodeKey, MapNode)` for every occupied leaf below `node` in Morton order; coarse leaves once.
template <typename Visit>
void forEachOccupiedLeafBelow(MapNode node, const NodeKey& key, float occupied_log_odds, const Visit& visit) {
  if (node.logOdds() < occupied_log_odds) return;  // an inner node has the largest log-odds below it
  if (node.isLeaf()) {
    visit(key, node);
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    if ((node.childMask() >> i & 1u) != 0) {
      forEachOccupiedLeafBelow(node.child(i), childOf(key, i), occupied_log_odds, visit);
    }
  }
}

/// The same for the whole map.
template <typename Visit>
void forEachOccupiedLeaf(const MapTree& map, const Visit& visit) {
  if (map.root) forEachOccupiedLeafBelow(map.root, NodeKey{}, map.occupied_log_odds, visit);
}

/// The leaf that covers the finest leaf at `key`, coarse or not; null where the map is unknown.
[[nodiscard]] inline MapNode findLeafNode(const MapTree& map, const LeafKey& key) {
  MapNode node = map.root;
  for (int depth = 0; node && !node.isLeaf(); ++depth) {
    const int bit = MapTree::kDepth - 1 - depth;
    const unsigned i = (key.x >> bit & 1u) | (key.y >> bit & 1u) << 1 | (key.z >> bit & 1u) << 2;
    node = (node.childMask() >> i & 1u) != 0 ? node.child(i) : MapNode();
  }
  return node;
}

}  // namespace saccade
