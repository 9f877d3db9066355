#include "saccade/map/ior_octree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <istream>
#include <limits>
#include <new>
#include <ostream>
#include <utility>

#include "map/node_pool.hpp"

namespace saccade {

static_assert(std::endian::native == std::endian::little, "node payloads are written as they lie in memory");

namespace {

/// Stands for log-odds of 0, with the sign of the update that led there: too small to matter, and not 0.
constexpr float kNearlyZero = 1e-6f;

bool equalLeaves(const IorOcTreeNode& a, Tick now_a, const IorOcTreeNode& b, Tick now_b) {
  return a.getLogOdds() == b.getLogOdds() && lasting(a.ior(), now_a) == lasting(b.ior(), now_b) &&
         a.surface() == b.surface();
}

void deriveInnerNodes(IorOcTreeNode* node) {
  for (unsigned mask = node->childMask(); mask != 0; mask &= mask - 1) {
    IorOcTreeNode* child = node->child(static_cast<unsigned>(std::countr_zero(mask)));
    if (!child->isLeaf()) deriveInnerNodes(child);
  }
  node->updateOccupancyChildren();
}

bool equalSubtrees(const IorOcTreeNode& a, Tick now_a, const IorOcTreeNode& b, Tick now_b) {
  if (a.isLeaf() != b.isLeaf() || a.childMask() != b.childMask()) return false;
  if (a.isLeaf()) return equalLeaves(a, now_a, b, now_b);
  if (a.getLogOdds() != b.getLogOdds()) return false;
  for (unsigned mask = a.childMask(); mask != 0; mask &= mask - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(mask));
    if (!equalSubtrees(*a.child(i), now_a, *b.child(i), now_b)) return false;
  }
  return true;
}

}  // namespace

// --- node -----------------------------------------------------------------------------------------------------------

bool IorOcTreeNode::operator==(const IorOcTreeNode& other) const {
  if (value != other.value || isLeaf() != other.isLeaf()) return false;
  return isLeaf() ? ior_ == other.ior_ && surface_ == other.surface_ : childMask() == other.childMask();
}

void IorOcTreeNode::copyData(const IorOcTreeNode& from) {
  value = from.value;
  ior_ = from.ior_;
  surface_ = from.surface_;
}

void IorOcTreeNode::updateOccupancyChildren() {
  float largest = -std::numeric_limits<float>::max();
  IorState inhibition;
  for (unsigned mask = childMask(); mask != 0; mask &= mask - 1) {
    const IorOcTreeNode* node = child(static_cast<unsigned>(std::countr_zero(mask)));
    largest = std::max(largest, node->value);
    inhibition = laterInhibition(inhibition, node->ior_);
  }
  value = largest;
  ior_ = inhibition;
  markChanged();  // whoever changed something below has to call this
}

void IorOcTreeNode::noteAttentionBelow(IorState latest) {
  ior_ = laterInhibition(ior_, latest);
  markChanged();
}

std::istream& IorOcTreeNode::readData(std::istream& s) {
  std::uint32_t ior_bits = 0;
  s.read(reinterpret_cast<char*>(&value), sizeof(value));
  s.read(reinterpret_cast<char*>(&ior_bits), sizeof(ior_bits));
  s.read(reinterpret_cast<char*>(&surface_), sizeof(surface_));
  ior_ = IorState::fromBits(ior_bits);
  return s;
}

std::ostream& IorOcTreeNode::writeData(std::ostream& s) const {
  const std::uint32_t ior_bits = isLeaf() ? ior_.bits() : 0;  // what inner nodes hold is derived when reading
  const LeafSurface surface = isLeaf() ? surface_ : LeafSurface{};
  s.write(reinterpret_cast<const char*>(&value), sizeof(value));
  s.write(reinterpret_cast<const char*>(&ior_bits), sizeof(ior_bits));
  s.write(reinterpret_cast<const char*>(&surface), sizeof(surface));
  return s;
}

// --- tree -----------------------------------------------------------------------------------------------------------

class IorOcTree::Registration {
 public:
  Registration() {
    auto* prototype = new IorOcTree(0.1);  // OctoMap's factory keeps and deletes it
    prototype->clearKeyRays();
    AbstractOcTree::registerTreeType(prototype);
  }
};

void IorOcTree::ensureLinking() {
  static const Registration registration;
}

IorOcTree::IorOcTree(double resolution)
    : octomap::OccupancyOcTreeBase<IorOcTreeNode>(resolution), pool_(std::make_unique<NodePool>()) {}

IorOcTree::~IorOcTree() {
  clear();
}  // here, as the base's destructor would find the pool gone

bool IorOcTree::operator==(const IorOcTree& other) const {
  if (resolution != other.resolution || tree_size != other.tree_size) return false;
  if ((root == nullptr) != (other.root == nullptr)) return false;
  return root == nullptr || equalSubtrees(*root, now_, *other.root, other.now_);
}

bool IorOcTree::isNodeCollapsible(const IorOcTreeNode* node) const {
  if (node->childMask() != 0xFF) return false;
  const IorOcTreeNode* first = node->child(0);
  for (unsigned i = 0; i < 8; ++i) {
    const IorOcTreeNode* child = node->child(i);
    if (!child->isLeaf() || !equalLeaves(*child, now_, *first, now_)) return false;
  }
  return true;
}

bool IorOcTree::pruneNode(IorOcTreeNode* node) {
  if (!isNodeCollapsible(node)) return false;
  const IorOcTreeNode* child = node->child(0);
  const float log_odds = child->value;
  const IorState ior = lasting(child->ior_, now_);
  const LeafSurface surface = child->surface_;
  releaseFamily(node);  // before the payload goes in, which lies where the child mask was
  node->value = log_odds;
  node->ior_ = ior;
  node->surface_ = surface;
  return true;
}

void IorOcTree::expandNode(IorOcTreeNode* node) {
  const float log_odds = node->value;
  const IorState ior = node->ior_;
  const LeafSurface surface = node->surface_;
  createFamily(node, 0xFF);
  for (unsigned i = 0; i < 8; ++i) {
    IorOcTreeNode* child = node->child(i);
    child->value = log_odds;
    child->ior_ = ior;
    child->surface_ = surface;
  }
}

void IorOcTree::updateNodeLogOdds(IorOcTreeNode* node, const float& update) const {
  float log_odds = std::clamp(node->value + update, clamping_thres_min, clamping_thres_max);
  if (log_odds == 0.0f) log_odds = std::copysign(kNearlyZero, update);
  node->value = log_odds;
  if (log_odds < occ_prob_thres_log) {  // a leaf that turns free is forgotten
    node->ior_ = {};
    node->surface_ = {};
  }
}

std::istream& IorOcTree::readData(std::istream& s) {
  octomap::OccupancyOcTreeBase<IorOcTreeNode>::readData(s);
  updateInnerNodes();
  return s;
}

IorOcTreeNode* IorOcTree::findFinestLeaf(const octomap::OcTreeKey& key) {
  IorOcTreeNode* node = root;
  if (node == nullptr) return nullptr;
  for (int level = static_cast<int>(tree_depth) - 1; level >= 0; --level) {
    const unsigned i = octomap::computeChildIdx(key, level);
    if (node->isLeaf()) expandNode(node);
    if ((node->childMask() >> i & 1u) == 0) return nullptr;
    node = node->child(i);
  }
  return node;
}

IorOcTreeNode* IorOcTree::ensureRoot() {
  if (root == nullptr) {
    root = new IorOcTreeNode();
    root->value = 0.0f;
    ++tree_size;
    size_changed = true;
  }
  return root;
}

void IorOcTree::createFamily(IorOcTreeNode* node, unsigned child_mask) {
  allocNodeChildren(node);
  for (unsigned mask = child_mask; mask != 0; mask &= mask - 1) {
    createInFamily(node, static_cast<unsigned>(std::countr_zero(mask)));
  }
}

IorOcTreeNode* IorOcTree::createInFamily(IorOcTreeNode* node, unsigned child_index) {
  IorOcTreeNode* child = ::new (node->familyNode(child_index)) IorOcTreeNode();
  child->value = 0.0f;
  node->children[child_index] = child;
  node->surface_.blue = static_cast<std::uint8_t>(node->surface_.blue | 1u << child_index);
  ++tree_size;
  size_changed = true;
  return child;
}

void IorOcTree::updateInnerNodes() {
  if (root != nullptr) updateInnerNodes(root);
}

void IorOcTree::updateInnerNodes(IorOcTreeNode* subtree) {
  if (!subtree->isLeaf()) deriveInnerNodes(subtree);
}

std::size_t IorOcTree::memoryUsage() const {
  return sizeof(IorOcTree) + sizeof(IorOcTreeNode) + pool_->bytes();
}

std::size_t IorOcTree::usedBytes() const {
  return pool_->usedBytes();
}

MapTree IorOcTree::view() const {
  return {MapNode(root), resolution, occ_prob_thres_log, now_};
}

void IorOcTree::releaseFamily(IorOcTreeNode* node) {
  for (unsigned mask = node->childMask(); mask != 0; mask &= mask - 1) {
    IorOcTreeNode* child = node->child(static_cast<unsigned>(std::countr_zero(mask)));
    if (!child->isLeaf()) releaseFamily(child);
    --tree_size;
  }
  pool_->release(node->children);  // nodes hold nothing, so their destructors are not needed
  node->children = nullptr;
  node->ior_ = {};
  node->surface_ = {};
  size_changed = true;
}

}  // namespace saccade

// --- OctoMap's allocation, replaced ---------------------------------------------------------------------------------

namespace octomap {

using saccade::IorOcTree;
using saccade::IorOcTreeNode;

template <>
void IorOcTreeImpl::allocNodeChildren(IorOcTreeNode* node) {
  auto* tree = static_cast<IorOcTree*>(this);  // no other class is made from this base
  node->children = static_cast<AbstractOcTreeNode**>(tree->pool_->allocate());
  for (unsigned i = 0; i < 8; ++i) node->children[i] = nullptr;
  node->becomeInner(0);
}

template <>
IorOcTreeNode* IorOcTreeImpl::createNodeChild(IorOcTreeNode* node, unsigned int child_index) {
  if (node->children == nullptr) allocNodeChildren(node);
  return static_cast<IorOcTree*>(this)->createInFamily(node, child_index);
}

template <>
void IorOcTreeImpl::deleteNodeChild(IorOcTreeNode* node, unsigned int child_index) {
  IorOcTreeNode* child = node->child(child_index);
  if (!child->isLeaf()) static_cast<IorOcTree*>(this)->releaseFamily(child);
  node->children[child_index] = nullptr;
  node->surface_.blue = static_cast<std::uint8_t>(node->surface_.blue & ~(1u << child_index));
  --tree_size;
  size_changed = true;
  if (node->childMask() == 0) static_cast<IorOcTree*>(this)->releaseFamily(node);  // no children: a leaf
}

template <>
void IorOcTreeImpl::deleteNodeRecurs(IorOcTreeNode* node) {
  // OctoMap calls this for the root only, which is the one node outside the pool.
  node->children = nullptr;
  static_cast<IorOcTree*>(this)->pool_->reset();
  delete node;
}

template <>
void IorOcTreeImpl::swapContent(IorOcTreeImpl& other) {
  std::swap(root, other.root);
  std::swap(tree_size, other.tree_size);
  std::swap(static_cast<IorOcTree*>(this)->pool_, static_cast<IorOcTree&>(other).pool_);
  size_changed = other.size_changed = true;
}

}  // namespace octomap
