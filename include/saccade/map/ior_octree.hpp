#pragma once

#include <cstddef>
#include <iosfwd>
#include <memory>
#include <string>

#include <octomap/OcTreeNode.h>
#include <octomap/OccupancyOcTreeBase.h>

#include "saccade/map/ior_law.hpp"
#include "saccade/map/leaf_surface.hpp"
#include "saccade/map/map_cursor.hpp"

/// The one public header that includes OctoMap: for those who want the tree itself (OctoMap's own tools and formats).
/// Everyone else uses IorMap and the cursor of map_cursor.hpp.
namespace saccade {

class IorOcTree;
class NodePool;

/// Node of the map, 24 bytes, the same as a plain `octomap::OcTreeNode` on the heap: children pointer 8, log-odds 4,
/// IOR 4, surface 8.
///
/// A leaf holds its IOR memory and its surface. An inner node holds the largest log-odds below it; its IOR says "an
/// inhibited leaf may be below, until this tick"; its surface bytes hold which children exist and whether anything
/// below was touched since clearChanged(). Nodes belong to a tree, which alone creates and deletes them.
class IorOcTreeNode : public octomap::OcTreeNode {
 public:
  IorOcTreeNode() = default;
  IorOcTreeNode(const IorOcTreeNode&) = delete;
  IorOcTreeNode& operator=(const IorOcTreeNode&) = delete;

  [[nodiscard]] IorState ior() const { return ior_; }
  void setIor(IorState ior) { ior_ = ior; }
  /// Surface of a leaf; without meaning for inner nodes.
  [[nodiscard]] const LeafSurface& surface() const { return surface_; }
  void setSurface(const LeafSurface& surface) { surface_ = surface; }

  [[nodiscard]] bool isLeaf() const { return children == nullptr; }
  /// Which children exist, as bits; 0 for a leaf.
  [[nodiscard]] unsigned childMask() const { return children == nullptr ? 0u : surface_.blue; }
  /// Whether something below an inner node may have changed since clearChanged(). A leaf keeps no such mark.
  [[nodiscard]] bool changedBelow() const { return surface_.green != 0; }
  void clearChanged() { surface_.green = 0; }
  /// Child i, which must exist.
  [[nodiscard]] IorOcTreeNode* child(unsigned i) { return familyNode(i); }
  [[nodiscard]] const IorOcTreeNode* child(unsigned i) const { return familyNode(i); }

  /// Equal log-odds and, of leaves, equal payload. Trees compare with their own ticks, see IorOcTree::operator==.
  bool operator==(const IorOcTreeNode& other) const;
  /// Copies log-odds, IOR and surface, not the children; both nodes must be leaves.
  void copyData(const IorOcTreeNode& from);
  /// Sets log-odds and IOR of an inner node from its children.
  void updateOccupancyChildren();
  /// Tells an inner node that leaves below it were attended, `latest` of them the one that inhibits longest.
  void noteAttentionBelow(IorState latest);

  /// `.ot` payload of a node: log-odds, IOR, surface; 16 bytes, little-endian.
  std::istream& readData(std::istream& s);
  std::ostream& writeData(std::ostream& s) const;

 private:
  friend class IorOcTree;
  friend class octomap::OcTreeBaseImpl<IorOcTreeNode, octomap::AbstractOccupancyOcTree>;

  [[nodiscard]] IorOcTreeNode* familyNode(unsigned i) const {
    return reinterpret_cast<IorOcTreeNode*>(reinterpret_cast<std::byte*>(children) + NodeLayout::kFamilyNodes) + i;
  }
  /// Ends being a leaf: drops the payload, as the bytes now hold the child mask.
  void becomeInner(unsigned child_mask) {
    surface_ = {};
    surface_.blue = static_cast<std::uint8_t>(child_mask);
    markChanged();
  }
  void markChanged() { surface_.green = 1; }

  IorState ior_;
  LeafSurface surface_;
};
static_assert(sizeof(IorOcTreeNode) == NodeLayout::kNodeBytes);

}  // namespace saccade

// OctoMap allocates every node and every array of child pointers by itself. For our node these members are replaced, so
// that the eight children of a node and their pointers are one block of the tree's own pool (see NodeLayout).
namespace octomap {
using IorOcTreeImpl = OcTreeBaseImpl<saccade::IorOcTreeNode, AbstractOccupancyOcTree>;
template <>
saccade::IorOcTreeNode* IorOcTreeImpl::createNodeChild(saccade::IorOcTreeNode* node, unsigned int child_index);
template <>
void IorOcTreeImpl::deleteNodeChild(saccade::IorOcTreeNode* node, unsigned int child_index);
template <>
void IorOcTreeImpl::allocNodeChildren(saccade::IorOcTreeNode* node);
template <>
void IorOcTreeImpl::deleteNodeRecurs(saccade::IorOcTreeNode* node);
template <>
void IorOcTreeImpl::swapContent(IorOcTreeImpl& other);
}  // namespace octomap

namespace saccade {

/// Occupancy octree of OctoMap whose occupied leaves remember attention (DESIGN: "The map"; paper, "3D IOR map").
///
/// Owns its nodes through a pool of its own: dropping the tree drops the pool. Works with all of OctoMap's functions,
/// `AbstractOcTree::read` included (type "IorOcTree"). Keeps three rules whatever is called: pruning is lossless for
/// the payload (a memory that is forgotten at `now()` counts as none); a leaf that turns free loses IOR and surface; an
/// update never leaves log-odds of exactly 0, which OctoMap 1.9.7 reads as occupied.
/// Leaves to others: the sensor's geometry (IorMap), time (setNow is the owner's duty).
///
/// Thread rule: as OctoMap's: any number of readers, or one writer; different trees are independent.
class IorOcTree : public octomap::OccupancyOcTreeBase<IorOcTreeNode> {
 public:
  /// An empty tree with finest leaves of `resolution` metres.
  explicit IorOcTree(double resolution);
  ~IorOcTree() override;
  IorOcTree(const IorOcTree&) = delete;
  IorOcTree& operator=(const IorOcTree&) = delete;

  [[nodiscard]] IorOcTree* create() const override { return new IorOcTree(resolution); }
  [[nodiscard]] std::string getTreeType() const override { return "IorOcTree"; }

  /// Makes `AbstractOcTree::read` know this type; call it once before reading. Needed with a static library, whose
  /// linker may drop a registration that nobody calls. Cheap, and safe to call again.
  static void ensureLinking();

  /// The tick that decides which memories are forgotten.
  [[nodiscard]] Tick now() const { return now_; }
  void setNow(Tick now) { now_ = now; }

  /// Same structure, log-odds and payload; memories forgotten at each tree's own tick count as none.
  [[nodiscard]] bool operator==(const IorOcTree& other) const;

  /// Whether all eight children are equal leaves, payload included.
  [[nodiscard]] bool isNodeCollapsible(const IorOcTreeNode* node) const override;
  bool pruneNode(IorOcTreeNode* node) override;
  void expandNode(IorOcTreeNode* node) override;
  void updateNodeLogOdds(IorOcTreeNode* node, const float& update) const override;
  /// Reads the nodes of an `.ot` stream and derives what inner nodes hold.
  std::istream& readData(std::istream& s) override;

  /// The finest leaf at `key`, made by splitting a coarse one if need be; null where the map is unknown.
  [[nodiscard]] IorOcTreeNode* findFinestLeaf(const octomap::OcTreeKey& key);

  /// Makes the root, as a leaf with log-odds 0, if there is none, and returns it.
  IorOcTreeNode* ensureRoot();
  /// Gives a childless node all of `child_mask` children at once, default constructed. For bulk updates.
  void createFamily(IorOcTreeNode* node, unsigned child_mask);
  /// Creates one child of a node that already has a family.
  IorOcTreeNode* createInFamily(IorOcTreeNode* node, unsigned child_index);
  /// Recomputes what inner nodes hold (log-odds, IOR) for the whole tree. Cost: every node.
  void updateInnerNodes();
  /// The same for the inner nodes from `subtree` down.
  static void updateInnerNodes(IorOcTreeNode* subtree);

  /// Bytes the tree holds from the operating system, free blocks included.
  [[nodiscard]] std::size_t memoryUsage() const override;
  /// Bytes of these that nodes take.
  [[nodiscard]] std::size_t usedBytes() const;

  /// View for traversal without OctoMap.
  [[nodiscard]] MapTree view() const;

 private:
  friend class octomap::OcTreeBaseImpl<IorOcTreeNode, octomap::AbstractOccupancyOcTree>;
  class Registration;

  void releaseFamily(IorOcTreeNode* node);

  std::unique_ptr<NodePool> pool_;
  Tick now_;
};

}  // namespace saccade
