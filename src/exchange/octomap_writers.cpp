#include <limits>
#include <ostream>
#include <string>

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include "saccade/exchange/octomap_files.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade {
namespace {

/// One of OctoMap's trees that is grown node by node; it names itself as its base does.
template <typename Tree>
class GrownTree : public Tree {
 public:
  using Node = typename Tree::NodeType;
  using Tree::Tree;

  Node* makeRoot() {
    this->root = new Node();
    this->tree_size = 1;
    this->size_changed = true;
    return this->root;
  }
};

/// Copies the nodes below `from`; `set_leaf` fills each leaf, `update_inner` what inner nodes derive. No deeper
/// than 16.
template <typename Tree, typename SetLeaf, typename UpdateInner>
void copyNodes(MapNode from, Tree& tree, typename Tree::NodeType* to, const SetLeaf& set_leaf,
               const UpdateInner& update_inner) {
  if (from.isLeaf()) {
    set_leaf(from, *to);
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    if ((from.childMask() >> i & 1u) == 0) continue;
    copyNodes(from.child(i), tree, tree.createNodeChild(to, i), set_leaf, update_inner);
  }
  update_inner(*to);
}

/// OctoMap's header. Its own writer gives the leaf size in six digits, which moves the far end of a large map.
void writeHeader(std::ostream& out, const char* first_line, const std::string& type, std::size_t nodes,
                 double leaf_size_m, const std::string& comment) {
  const auto precision = out.precision(std::numeric_limits<double>::digits10);
  out << first_line << "\n# (feel free to add / change comments, but leave the first line as it is!)\n"
      << comment << "id " << type << "\nsize " << nodes << "\nres " << leaf_size_m << "\ndata\n";
  out.precision(precision);
}

constexpr const char* kFullFirstLine = "# Octomap OcTree file";
constexpr const char* kBinaryFirstLine = "# Octomap OcTree binary file";

}  // namespace

void writeIorOctree(const IorMap& map, std::ostream& out) {
  const IorOcTree& tree = map.tree();
  writeHeader(out, kFullFirstLine, tree.getTreeType(), tree.size(), tree.getResolution(),
              "# saccade tick " + std::to_string(map.now().value) + "\n");
  tree.writeData(out);
}

void writeColorOctree(const IorMap& map, LeafPaint paint, std::ostream& out) {
  const MapTree view = map.view();
  GrownTree<octomap::ColorOcTree> tree(view.leaf_size_m);
  if (view.root) {
    const auto set_leaf = [&](MapNode leaf, octomap::ColorOcTreeNode& node) {
      node.setLogOdds(leaf.logOdds());
      if (leaf.logOdds() < view.occupied_log_odds) return;  // free leaves have no colour
      const Rgb color = paintLeaf(leaf.ior(), leaf.surface(), view.now, paint);
      node.setColor(color[0], color[1], color[2]);
    };
    copyNodes(view.root, tree, tree.makeRoot(), set_leaf, [](octomap::ColorOcTreeNode& node) {
      node.updateOccupancyChildren();
      node.updateColorChildren();
    });
  }
  writeHeader(out, kFullFirstLine, tree.getTreeType(), tree.size(), tree.getResolution(), "");
  tree.writeData(out);
}

void writeBinaryOctree(const IorMap& map, std::ostream& out) {
  const MapTree view = map.view();
  GrownTree<octomap::OcTree> tree(view.leaf_size_m);
  if (view.root) {
    const float occupied = tree.getClampingThresMaxLog(), free = tree.getClampingThresMinLog();
    const auto set_leaf = [&](MapNode leaf, octomap::OcTreeNode& node) {
      node.setLogOdds(leaf.logOdds() >= view.occupied_log_odds ? occupied : free);
    };
    octomap::OcTreeNode* root = tree.makeRoot();
    copyNodes(view.root, tree, root, set_leaf, [](octomap::OcTreeNode& node) { node.updateOccupancyChildren(); });
    tree.prune();
    if (!tree.nodeHasChildren(root)) tree.expandNode(root);  // the format cannot say what a lone root is
  }
  writeHeader(out, kBinaryFirstLine, tree.getTreeType(), tree.size(), tree.getResolution(), "");
  tree.writeBinaryData(out);
}

}  // namespace saccade
