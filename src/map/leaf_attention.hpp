#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "saccade/map/ior_map.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade {

/// Attends leaves in one descent that touches each node once: what IorMap::attend() does within a tick.
///
/// Owns scratch memory only; does not close the tick.
class LeafAttention {
 public:
  explicit LeafAttention(const IorMapConfig& config) : config_(config) {}

  /// Attends each of `keys`, or each leaf of their blocks, once.
  AttentionReport attend(IorOcTree& tree, std::span<const LeafKey> keys);

 private:
  using Codes = std::span<const std::uint64_t>;

  void listCodes(std::span<const LeafKey> keys);
  IorState attendBelow(IorOcTreeNode* node, int level, Codes codes);
  IorState attendFamily(IorOcTreeNode* node, Codes codes);
  IorState attendLeaf(IorOcTreeNode* leaf, std::uint64_t code);
  [[nodiscard]] int leavesOf(Codes codes) const;

  IorMapConfig config_;
  std::vector<std::uint64_t> codes_;  // Morton codes of the leaves, or of the first leaves of the blocks, to attend

  // Of the call in work:
  IorOcTree* tree_ = nullptr;
  AttentionReport report_;
};

}  // namespace saccade
