#include "map/leaf_attention.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "saccade/map/morton_code.hpp"

namespace saccade {
namespace {

constexpr std::uint64_t kDigit = 7;  // one child number of a Morton code

unsigned childAt(std::uint64_t code, int level) {
  return static_cast<unsigned>(code >> (3 * level) & kDigit);
}

bool hasChild(const IorOcTreeNode* node, unsigned i) {
  return (node->childMask() >> i & 1u) != 0;
}

}  // namespace

AttentionReport LeafAttention::attend(IorOcTree& tree, std::span<const LeafKey> keys) {
  tree_ = &tree;
  report_ = {};
  report_.tick = tree.now();
  listCodes(keys);
  if (tree.getRoot() != nullptr) {
    attendBelow(tree.getRoot(), MapTree::kDepth - 1, codes_);
  } else {
    report_.missing = leavesOf(codes_);
  }
  return std::move(report_);
}

void LeafAttention::listCodes(std::span<const LeafKey> keys) {
  const std::uint64_t kept = config_.attend_blocks ? ~kDigit : ~std::uint64_t{0};
  codes_.clear();
  for (const LeafKey& key : keys) codes_.push_back(mortonCode(key) & kept);
  if (!std::is_sorted(codes_.begin(), codes_.end())) std::sort(codes_.begin(), codes_.end());
  codes_.erase(std::unique(codes_.begin(), codes_.end()), codes_.end());
}

int LeafAttention::leavesOf(Codes codes) const {
  return static_cast<int>(codes.size()) * (config_.attend_blocks ? 8 : 1);
}

/// Attends the leaves of `codes`, all of them below `node`, whose children differ in digit `level`. The state below it
/// that inhibits longest, of those that were attended.
IorState LeafAttention::attendBelow(IorOcTreeNode* node, int level, Codes codes) {
  if (node->isLeaf()) {
    if (!tree_->isNodeOccupied(node)) {
      report_.missing += leavesOf(codes);
      return {};
    }
    tree_->expandNode(node);  // its leaves will differ
  }
  const int attended_before = report_.attended;
  IorState latest;
  if (level == 0) {
    latest = attendFamily(node, codes);
  } else {
    while (!codes.empty()) {
      const unsigned i = childAt(codes.front(), level);
      const auto end = std::find_if(codes.begin(), codes.end(), [&](auto code) { return childAt(code, level) != i; });
      const Codes below = codes.first(static_cast<std::size_t>(end - codes.begin()));
      codes = codes.subspan(below.size());
      if (hasChild(node, i)) {
        latest = laterInhibition(latest, attendBelow(node->child(i), level - 1, below));
      } else {
        report_.missing += leavesOf(below);
      }
    }
  }
  if (report_.attended > attended_before) node->noteAttentionBelow(latest);
  return latest;
}

/// Attends finest leaves: those of `codes`, or, where these stand for blocks, all eight.
IorState LeafAttention::attendFamily(IorOcTreeNode* node, Codes codes) {
  IorState latest;
  const auto attendChild = [&](std::uint64_t code) {
    const unsigned i = childAt(code, 0);
    if (hasChild(node, i) && tree_->isNodeOccupied(node->child(i))) {
      latest = laterInhibition(latest, attendLeaf(node->child(i), code));
    } else {
      ++report_.missing;
    }
  };
  for (const std::uint64_t code : codes) {
    if (!config_.attend_blocks) {
      attendChild(code);
      continue;
    }
    for (std::uint64_t i = 0; i <= kDigit; ++i) attendChild(code | i);
  }
  return latest;
}

IorState LeafAttention::attendLeaf(IorOcTreeNode* leaf, std::uint64_t code) {
  const Tick now = tree_->now();
  const IorState after = saccade::attend(leaf->ior(), now, config_.ior);
  if (after.flag() && !inhibited(leaf->ior(), now)) report_.flags_on.push_back(keyOfMortonCode(code));
  leaf->setIor(after);
  ++report_.attended;
  return after;
}

}  // namespace saccade
