#include "saccade/exchange/map_difference.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_set>

#include <fmt/format.h>

namespace saccade {
namespace {

using KeySet = std::unordered_set<LeafKey>;

/// Calls `visit` for every finest occupied leaf, coarse ones leaf by leaf.
template <typename Visit>
void forEachOccupied(const IorMap& map, const Visit& visit) {
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (!leaf.occupied) return;
    const int edge = 1 << (MapTree::kDepth - leaf.key.depth);
    const LeafKey& corner = leaf.key.corner;
    for (int i = 0; i < edge; ++i) {
      for (int j = 0; j < edge; ++j) {
        for (int k = 0; k < edge; ++k) {
          visit(LeafKey{static_cast<std::uint16_t>(corner.x + i), static_cast<std::uint16_t>(corner.y + j),
                        static_cast<std::uint16_t>(corner.z + k)},
                leaf);
        }
      }
    }
  });
}

/// Calls `visit` for the leaves within `reach` of `key`, the leaf itself included, until it returns true; whether it
/// did.
template <typename Visit>
bool anyNeighbour(const LeafKey& key, int reach, const Visit& visit) {
  constexpr int kLastKey = 65535;
  for (int x = std::max(0, key.x - reach); x <= std::min(kLastKey, key.x + reach); ++x) {
    for (int y = std::max(0, key.y - reach); y <= std::min(kLastKey, key.y + reach); ++y) {
      for (int z = std::max(0, key.z - reach); z <= std::min(kLastKey, key.z + reach); ++z) {
        if (visit(LeafKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(z)}))
          return true;
      }
    }
  }
  return false;
}

bool isOccupied(const IorMap& map, const LeafKey& key) {
  const auto leaf = map.findLeaf(key);
  return leaf && leaf->occupied;
}

struct OneSided {
  std::vector<LeafKey> changed;  ///< free in the other map, no surface of it near by
  std::size_t same = 0, unknown = 0;
};

/// What of `map`'s surface the other map lacks.
OneSided lackingIn(const IorMap& map, const IorMap& other, int tolerance) {
  OneSided result;
  forEachOccupied(map, [&](const LeafKey& key, const MapLeaf&) {
    const auto occupied = [&](const LeafKey& near) { return isOccupied(other, near); };
    if (occupied(key) || anyNeighbour(key, tolerance, occupied)) {
      ++result.same;
    } else if (other.findLeaf(key)) {
      result.changed.push_back(key);
    } else {
      ++result.unknown;
    }
  });
  return result;
}

void describeRegion(ChangedRegion& region, const IorMap& map) {
  std::sort(region.leaves.begin(), region.leaves.end());
  const double leaf_m = map.config().leaf_size_m;
  double colored = 0.0;
  for (const LeafKey& key : region.leaves) {
    const Eigen::Vector3d centre = map.centre(key);
    region.mean_W += centre;
    region.box_W.extend(centre - Eigen::Vector3d::Constant(leaf_m / 2));
    region.box_W.extend(centre + Eigen::Vector3d::Constant(leaf_m / 2));
    const LeafSurface surface = map.findLeaf(key)->surface;
    if (surface.observations == 0) continue;
    region.mean_bgr += Eigen::Vector3d(surface.blue, surface.green, surface.red);
    colored += 1.0;
  }
  region.mean_W /= static_cast<double>(region.leaves.size());
  if (colored > 0.0) region.mean_bgr /= colored;
}

/// Connected components, gaps of one leaf included; those with fewer than `least` leaves are left out.
std::vector<ChangedRegion> regionsOf(const std::vector<LeafKey>& changed, const IorMap& map, int least) {
  constexpr int kGap = 2;
  KeySet waiting(changed.begin(), changed.end());
  std::vector<ChangedRegion> regions;
  for (const LeafKey& seed : changed) {
    if (waiting.erase(seed) == 0) continue;
    ChangedRegion region;
    region.leaves.push_back(seed);
    for (std::size_t next = 0; next < region.leaves.size(); ++next) {
      anyNeighbour(LeafKey(region.leaves[next]), kGap, [&](const LeafKey& near) {
        if (waiting.erase(near) != 0) region.leaves.push_back(near);
        return false;
      });
    }
    if (static_cast<int>(region.leaves.size()) < least) continue;
    describeRegion(region, map);
    regions.push_back(std::move(region));
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const ChangedRegion& x, const ChangedRegion& y) { return x.leaves.size() > y.leaves.size(); });
  return regions;
}

/// Likeness of two regions: ratio of their numbers of leaves, of their boxes' diagonals, and nearness of their colours.
double likeness(const ChangedRegion& a, const ChangedRegion& b) {
  const auto ratio = [](double x, double y) { return std::min(x, y) / std::max(x, y); };
  constexpr double kUnlikeColor = 128.0;  // distance in BGR at which nothing is left of the likeness
  const double leaves = ratio(static_cast<double>(a.leaves.size()), static_cast<double>(b.leaves.size()));
  const double extent = ratio(a.box_W.diagonal().norm(), b.box_W.diagonal().norm());
  const double color = std::max(0.0, 1.0 - (a.mean_bgr - b.mean_bgr).norm() / kUnlikeColor);
  return std::cbrt(leaves * extent * color);
}

std::vector<MovedRegion> pairMoved(const MapDifference& difference, double least_likeness) {
  std::vector<MovedRegion> pairs;
  for (std::size_t g = 0; g < difference.gone.size(); ++g) {
    for (std::size_t a = 0; a < difference.appeared.size(); ++a) {
      const double like = likeness(difference.gone[g], difference.appeared[a]);
      if (like >= least_likeness) pairs.push_back({g, a, like});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const MovedRegion& x, const MovedRegion& y) { return x.likeness > y.likeness; });
  std::vector<bool> gone_taken(difference.gone.size()), appeared_taken(difference.appeared.size());
  std::vector<MovedRegion> moved;
  for (const MovedRegion& pair : pairs) {
    if (gone_taken[pair.gone] || appeared_taken[pair.appeared]) continue;
    gone_taken[pair.gone] = appeared_taken[pair.appeared] = true;
    moved.push_back(pair);
  }
  return moved;
}

void compareAttention(const IorMap& a, const IorMap& b, MapDifference& difference) {
  forEachOccupied(a, [&](const LeafKey&, const MapLeaf& leaf) {
    difference.attended_a += weight(leaf.ior, a.now()) > 0 ? 1 : 0;
    difference.inhibited_a += inhibited(leaf.ior, a.now()) ? 1 : 0;
  });
  forEachOccupied(b, [&](const LeafKey& key, const MapLeaf& leaf) {
    const std::uint32_t later = weight(leaf.ior, b.now());
    difference.attended_b += later > 0 ? 1 : 0;
    difference.inhibited_b += inhibited(leaf.ior, b.now()) ? 1 : 0;
    if (later == 0) return;
    const auto before = a.findLeaf(key);
    if (!before || weight(before->ior, a.now()) < later) difference.attention_gained.push_back(key);
  });
}

}  // namespace

MapDifference compareMaps(const IorMap& a, const IorMap& b, const MapDifferenceConfig& config) {
  if (a.config().leaf_size_m != b.config().leaf_size_m) {
    throw std::invalid_argument(fmt::format("maps with leaves of {} and {} m cannot be compared leaf by leaf",
                                            a.config().leaf_size_m, b.config().leaf_size_m));
  }
  MapDifference difference;
  const OneSided of_a = lackingIn(a, b, config.tolerance_leaves);
  const OneSided of_b = lackingIn(b, a, config.tolerance_leaves);
  difference.gone = regionsOf(of_a.changed, a, config.least_leaves);
  difference.appeared = regionsOf(of_b.changed, b, config.least_leaves);
  difference.same = of_a.same;
  difference.only_a = of_a.unknown;
  difference.only_b = of_b.unknown;
  difference.moved = pairMoved(difference, config.least_likeness);
  compareAttention(a, b, difference);
  return difference;
}

}  // namespace saccade
