#include "saccade/exchange/map_merge.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "saccade/map/ior_octree.hpp"

namespace saccade {
namespace {

/// A node of one of the maps, or nothing. Below a leaf it stays that leaf.
struct Source {
  MapNode node;

  [[nodiscard]] bool isLeaf() const { return node && node.isLeaf(); }
  [[nodiscard]] Source child(unsigned i) const {
    if (!node || node.isLeaf()) return *this;
    return {(node.childMask() >> i & 1u) != 0 ? node.child(i) : MapNode()};
  }
};

std::uint8_t weighted(double a, double weight_a, double b, double weight_b) {
  return static_cast<std::uint8_t>((a * weight_a + b * weight_b) / (weight_a + weight_b) + 0.5);
}

LeafSurface meanSurface(const LeafSurface& a, const LeafSurface& b) {
  if (a.observations == 0) return b;
  if (b.observations == 0) return a;
  const double of_a = a.observations, of_b = b.observations;
  LeafSurface mean;
  mean.blue = weighted(a.blue, of_a, b.blue, of_b);
  mean.green = weighted(a.green, of_a, b.green, of_b);
  mean.red = weighted(a.red, of_a, b.red, of_b);
  const Eigen::Vector3f normal = a.normal() * a.observations + b.normal() * b.observations;
  if (normal.squaredNorm() > 0.0f) mean.setNormal(normal.normalized());
  mean.observations = static_cast<std::uint16_t>(std::min(65535.0, of_a + of_b));
  return mean;
}

class Merger {
 public:
  Merger(const IorMap& a, const IorMap& b, IorMap& to)
      : a_(a.view()), b_(b.view()), to_(to), tree_(to.tree()), occupied_(a_.occupied_log_odds) {}

  MapMergeReport run() {
    if (!a_.root && !b_.root) return report_;
    merge({a_.root}, {b_.root}, tree_.ensureRoot());
    tree_.updateInnerNodes();
    tree_.prune();
    return report_;
  }

 private:
  void merge(const Source& a, const Source& b, IorOcTreeNode* node) {
    const bool a_ends = !a.node || a.isLeaf(), b_ends = !b.node || b.isLeaf();
    if (a_ends && b_ends) {
      setLeaf(a.node, b.node, node);
      return;
    }
    for (unsigned i = 0; i < 8; ++i) {
      const Source child_a = a.child(i), child_b = b.child(i);
      if (child_a.node || child_b.node) merge(child_a, child_b, tree_.createNodeChild(node, i));
    }
  }

  void setLeaf(MapNode a, MapNode b, IorOcTreeNode* leaf) {
    if (!a || !b) {
      const MapNode known = a ? a : b;
      leaf->setLogOdds(known.logOdds());
      if (known.logOdds() < occupied_) return;
      leaf->setIor(shifted(known.ior(), a ? a_.now : b_.now));
      leaf->setSurface(known.surface());
      return;
    }
    ++report_.common;
    float log_odds =
        std::clamp(a.logOdds() + b.logOdds(), tree_.getClampingThresMinLog(), tree_.getClampingThresMaxLog());
    constexpr float kHardlyFree = -1e-6f;  // 0 would be unknown; two maps that cancel out saw nothing there
    if (log_odds == 0.0f) log_odds = kHardlyFree;
    leaf->setLogOdds(log_odds);
    const bool in_a = a.logOdds() >= occupied_, in_b = b.logOdds() >= occupied_;
    const bool remembered_any = (in_a && weight(a.ior(), a_.now) > 0) || (in_b && weight(b.ior(), b_.now) > 0);
    if (in_a != in_b && remembered_any) ++report_.lifted;
    if (log_odds < occupied_) return;
    leaf->setSurface(meanSurface(in_a ? a.surface() : LeafSurface{}, in_b ? b.surface() : LeafSurface{}));
    if (in_a != in_b) return;
    const IorState of_a = shifted(a.ior(), a_.now), of_b = shifted(b.ior(), b_.now);
    const IorState longer = of_a.expiry() >= of_b.expiry() ? of_a : of_b;
    const bool equal = of_a.expiry() == of_b.expiry();
    leaf->setIor({longer.expiry(), longer.flag() || (equal && of_b.flag())});
  }

  /// The memory with what remains of it counted from the merged map's now.
  [[nodiscard]] IorState shifted(IorState ior, Tick now) const {
    const std::uint32_t remaining = weight(ior, now);
    if (remaining == 0) return lasting(ior, now);
    const std::uint64_t expiry = std::uint64_t{to_.now().value} + remaining;
    return {static_cast<std::uint32_t>(std::min<std::uint64_t>(expiry, IorState::kLastExpiry)), ior.flag()};
  }

  const MapTree a_, b_;
  IorMap& to_;
  IorOcTree& tree_;
  float occupied_;
  MapMergeReport report_;
};

}  // namespace

IorMap mergeMaps(const IorMap& a, const IorMap& b, MapMergeReport* report) {
  if (a.config().leaf_size_m != b.config().leaf_size_m) {
    throw std::invalid_argument(fmt::format("maps with leaves of {} and {} m cannot be merged leaf by leaf",
                                            a.config().leaf_size_m, b.config().leaf_size_m));
  }
  IorMap merged(a.config());
  merged.setNow({a.now().value + b.now().value});
  const MapMergeReport done = Merger(a, b, merged).run();
  if (report != nullptr) *report = done;
  return merged;
}

}  // namespace saccade
