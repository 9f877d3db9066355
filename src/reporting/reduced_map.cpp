#include "reporting/reduced_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "inspection/leaf_walk.hpp"

namespace saccade {
namespace {

/// Occupied nodes of each depth, and occupied leaves above it: the points that a cell of that depth gives.
struct DepthCounts {
  std::array<std::size_t, MapTree::kDepth + 1> nodes{}, leaves{};
  std::array<int, 3> low{2 * MapTree::kCentreKey, 2 * MapTree::kCentreKey, 2 * MapTree::kCentreKey}, high{};

  [[nodiscard]] std::size_t pointsAt(int depth) const {
    std::size_t points = nodes[static_cast<std::size_t>(depth)];
    for (int above = 0; above < depth; ++above) points += leaves[static_cast<std::size_t>(above)];
    return points;
  }
  [[nodiscard]] int extent() const {
    int largest = 0;
    for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, high[i] - low[i]);
    return largest;
  }
};

std::array<int, 3> cornerOf(const NodeKey& key) {
  return {key.corner.x, key.corner.y, key.corner.z};
}

void countBelow(MapNode node, const NodeKey& key, float occupied_log_odds, DepthCounts& counts) {
  if (node.logOdds() < occupied_log_odds) return;
  ++counts.nodes[static_cast<std::size_t>(key.depth)];
  if (node.isLeaf()) {
    ++counts.leaves[static_cast<std::size_t>(key.depth)];
    const std::array<int, 3> corner = cornerOf(key);
    for (std::size_t i = 0; i < 3; ++i) {
      counts.low[i] = std::min(counts.low[i], corner[i]);
      counts.high[i] = std::max(counts.high[i], corner[i] + (1 << (MapTree::kDepth - key.depth)));
    }
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    if ((node.childMask() >> i & 1u) != 0) countBelow(node.child(i), childOf(key, i), occupied_log_odds, counts);
  }
}

/// The finest depth whose cells are few enough and can be counted in halves with 16 bits.
int depthFor(const DepthCounts& counts, std::size_t most_points) {
  constexpr int kMostCells = 32'767;
  int depth = MapTree::kDepth;
  while (depth > 0 &&
         (counts.pointsAt(depth) > most_points || (counts.extent() >> (MapTree::kDepth - depth)) + 1 > kMostCells)) {
    --depth;
  }
  return depth;
}

/// What the leaves within one cell have in common.
struct CellSum {
  Eigen::Vector3f color = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();  ///< colour: red, green, blue
  float leaves = 0.0f;
  std::uint32_t weight = 0;
  bool inhibited = false;

  void add(MapNode leaf, Tick now) {
    const LeafSurface surface = leaf.surface();
    color += Eigen::Vector3f(surface.red, surface.green, surface.blue);
    normal += surface.normal();
    leaves += 1.0f;
    weight = std::max(weight, saccade::weight(leaf.ior(), now));
    inhibited = inhibited || saccade::inhibited(leaf.ior(), now);
  }
};

/// Octahedral form of a direction in two signed bytes (Cigolle et al. 2014).
std::array<std::int8_t, 2> octahedral(const Eigen::Vector3f& normal) {
  constexpr std::int8_t kNone = -128;
  const float length = normal.lpNorm<1>();
  if (length <= 0.0f) return {kNone, kNone};
  Eigen::Vector2f p = normal.head<2>() / length;
  if (normal.z() < 0.0f) {
    const auto sign = [](float v) { return v < 0.0f ? -1.0f : 1.0f; };
    p = {(1.0f - std::abs(p.y())) * sign(p.x()), (1.0f - std::abs(p.x())) * sign(p.y())};
  }
  const auto quantised = [](float v) { return static_cast<std::int8_t>(std::lround(v * 127.0f)); };
  return {quantised(p.x()), quantised(p.y())};
}

class Reducer {
 public:
  Reducer(const MapTree& map, int depth, const std::array<int, 3>& low) : map_(map), depth_(depth) {
    reduced_.cell_m = map.nodeSize_m(depth);
    const int cell = 1 << (MapTree::kDepth - depth);
    for (std::size_t i = 0; i < 3; ++i) {
      low_[i] = low[i] - low[i] % cell;
      reduced_.origin_W[static_cast<Eigen::Index>(i)] = (low_[i] - MapTree::kCentreKey) * map.leaf_size_m;
    }
  }

  void walk(MapNode node, const NodeKey& key) {
    if (node.logOdds() < map_.occupied_log_odds) return;
    if (node.isLeaf() || key.depth == depth_) {
      CellSum sum;
      forEachOccupiedLeafBelow(node, key, map_.occupied_log_odds,
                               [&](const NodeKey&, MapNode leaf) { sum.add(leaf, map_.now); });
      put(key, sum);
      return;
    }
    for (unsigned i = 0; i < 8; ++i) {
      if ((node.childMask() >> i & 1u) != 0) walk(node.child(i), childOf(key, i));
    }
  }

  ReducedMap finish() {
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      const std::uint32_t share =
          reduced_.largest_weight == 0
              ? 0
              : static_cast<std::uint32_t>((std::uint64_t{weights_[i]} * 127 + reduced_.largest_weight - 1) /
                                           reduced_.largest_weight);
      reduced_.bytes[i * ReducedMap::kPointBytes + kAttentionByte] |= static_cast<std::uint8_t>(share);
    }
    return std::move(reduced_);
  }

 private:
  static constexpr std::size_t kAttentionByte = 9;

  void put(const NodeKey& key, const CellSum& sum) {
    const int cell = 1 << (MapTree::kDepth - depth_);  // in finest leaves
    const int edge = 1 << (MapTree::kDepth - key.depth);
    const std::array<int, 3> corner = cornerOf(key);
    for (std::size_t i = 0; i < 3; ++i) {
      const int centre = (2 * (corner[i] - low_[i]) + edge) / cell;  // in halves of a cell
      reduced_.bytes.push_back(static_cast<std::uint8_t>(centre & 255));
      reduced_.bytes.push_back(static_cast<std::uint8_t>(centre >> 8));
    }
    for (int i = 0; i < 3; ++i) {
      reduced_.bytes.push_back(static_cast<std::uint8_t>(std::lround(sum.color[i] / sum.leaves)));
    }
    reduced_.bytes.push_back(sum.inhibited ? 128 : 0);  // finish() adds the weight
    for (const std::int8_t part : octahedral(sum.normal)) reduced_.bytes.push_back(static_cast<std::uint8_t>(part));
    reduced_.bytes.push_back(static_cast<std::uint8_t>(depth_ - key.depth));
    reduced_.bytes.push_back(0);
    weights_.push_back(sum.weight);
    reduced_.largest_weight = std::max(reduced_.largest_weight, sum.weight);
  }

  const MapTree& map_;
  int depth_;
  std::array<int, 3> low_{};
  ReducedMap reduced_;
  std::vector<std::uint32_t> weights_;
};

}  // namespace

ReducedMap reduceMap(const MapTree& map, std::size_t most_points) {
  if (!map.root) return {};
  DepthCounts counts;
  countBelow(map.root, NodeKey{}, map.occupied_log_odds, counts);
  if (counts.nodes[0] == 0) return {};
  Reducer reducer(map, depthFor(counts, most_points), counts.low);
  reducer.walk(map.root, NodeKey{});
  return reducer.finish();
}

}  // namespace saccade
