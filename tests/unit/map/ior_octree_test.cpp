#include "saccade/map/ior_octree.hpp"

#include <memory>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

namespace saccade {
namespace {

constexpr double kLeafSize_m = 0.05;

octomap::OcTreeKey keyNear(std::mt19937& random, int reach) {
  std::uniform_int_distribution<int> offset(-reach, reach);
  const auto one = [&] { return static_cast<octomap::key_type>(32768 + offset(random)); };
  const auto x = one(), y = one(), z = one();
  return {x, y, z};
}

/// A tree with occupied and free leaves, some of them with memory and surface, through OctoMap's own functions.
void fillRandomly(IorOcTree& tree, unsigned seed, int updates) {
  std::mt19937 random(seed);
  for (int i = 0; i < updates; ++i) tree.updateNode(keyNear(random, 9), random() % 3 != 0);
  for (int i = 0; i < updates / 10; ++i) {
    IorOcTreeNode* leaf = tree.findFinestLeaf(keyNear(random, 9));
    if (leaf == nullptr || !tree.isNodeOccupied(leaf)) continue;
    leaf->setIor(IorState(static_cast<std::uint32_t>(random() % 100), random() % 2 == 0));
    LeafSurface surface;
    surface.red = static_cast<std::uint8_t>(random());
    surface.observations = 3;
    leaf->setSurface(surface);
  }
  tree.updateInnerNodes();
}

/// Nodes as the cursor sees them, compared one by one with the tree's own accessors.
void expectCursorAgrees(const IorOcTree& tree, MapNode view, const IorOcTreeNode* node) {
  ASSERT_EQ(view.isLeaf(), !tree.nodeHasChildren(node));
  ASSERT_EQ(view.logOdds(), node->getLogOdds());
  ASSERT_EQ(view.ior(), node->ior());
  if (view.isLeaf()) {
    ASSERT_EQ(view.surface(), node->surface());
    return;
  }
  for (unsigned i = 0; i < 8; ++i) {
    ASSERT_EQ((view.childMask() >> i & 1u) != 0, tree.nodeChildExists(node, i));
    if (tree.nodeChildExists(node, i)) {
      ASSERT_EQ(view.child(i), MapNode(tree.getNodeChild(node, i)));
      expectCursorAgrees(tree, view.child(i), tree.getNodeChild(node, i));
    }
  }
}

TEST(IorOcTree, HoldsTheSameOccupancyAsOctoMapsTreeAfterTheSameUpdates) {
  IorOcTree tree(kLeafSize_m);
  octomap::OcTree reference(kLeafSize_m);
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {  // many hits on few leaves: clamped blocks that prune and split again
    const auto key = keyNear(random, 2);
    tree.updateNode(key, true);
    reference.updateNode(key, true);
  }
  EXPECT_EQ(tree.size(), reference.size());
  for (int i = 0; i < 40000; ++i) {
    const auto key = keyNear(random, 6);
    const bool hit = random() % 3 == 0;
    tree.updateNode(key, hit);
    reference.updateNode(key, hit);
  }
  EXPECT_EQ(tree.size(), reference.size());
  EXPECT_EQ(tree.calcNumNodes(), tree.size());
  EXPECT_EQ(tree.getNumLeafNodes(), reference.getNumLeafNodes());
  auto ours = tree.begin_tree();
  for (auto it = reference.begin_tree(); it != reference.end_tree(); ++it, ++ours) {
    ASSERT_EQ(it.getKey(), ours.getKey());
    ASSERT_EQ(it.getDepth(), ours.getDepth());
    ASSERT_EQ(it->getLogOdds(), ours->getLogOdds());
  }
}

TEST(IorOcTree, CursorSeesEveryNodeAsTheTreeDoes) {
  IorOcTree tree(kLeafSize_m);
  EXPECT_FALSE(tree.view().root);
  fillRandomly(tree, 5, 5000);
  ASSERT_TRUE(tree.view().root);
  expectCursorAgrees(tree, tree.view().root, tree.getRoot());
}

TEST(IorOcTree, IsEqualAfterWritingAndReadingThroughOctoMapsFactory) {
  IorOcTree::ensureLinking();
  IorOcTree::ensureLinking();
  IorOcTree tree(kLeafSize_m);
  fillRandomly(tree, 11, 5000);
  std::stringstream stream;
  ASSERT_TRUE(tree.write(stream));
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(stream));
  const auto* again = dynamic_cast<const IorOcTree*>(read.get());
  ASSERT_NE(again, nullptr);
  EXPECT_TRUE(*again == tree);
  expectCursorAgrees(*again, again->view().root, again->getRoot());
  EXPECT_EQ(again->getRoot()->ior(), tree.getRoot()->ior());
}

TEST(IorOcTree, ExpandedAndPrunedIsTheSameTree) {
  IorOcTree tree(kLeafSize_m), twin(kLeafSize_m);
  for (IorOcTree* t : {&tree, &twin}) {  // a few leaves, so that expanding stays small
    for (octomap::key_type x = 0; x < 8; ++x)
      for (octomap::key_type y = 0; y < 8; ++y)
        for (octomap::key_type z = 0; z < 8; ++z)
          t->updateNode(octomap::OcTreeKey(32768 + x, 32768 + y, 32768 + z), x == 3);
    t->findFinestLeaf({32771, 32768, 32768})->setIor(IorState(50, true));
    t->prune();
    t->updateInnerNodes();
  }
  const std::size_t pruned_size = tree.size();
  tree.expand();
  EXPECT_GT(tree.size(), pruned_size);
  EXPECT_FALSE(tree == twin);
  tree.prune();
  EXPECT_EQ(tree.size(), pruned_size);
  EXPECT_TRUE(tree == twin);
}

TEST(IorOcTree, PruningKeepsLeavesThatDifferOnlyInMemoryUntilAllHaveForgotten) {
  IorOcTree tree(kLeafSize_m);
  for (int i = 0; i < 8; ++i) {
    const octomap::OcTreeKey key(static_cast<octomap::key_type>(32768 + (i & 1)),
                                 static_cast<octomap::key_type>(32768 + (i >> 1 & 1)),
                                 static_cast<octomap::key_type>(32768 + (i >> 2)));
    tree.setNodeValue(key, 3.0f);
    tree.findFinestLeaf(key)->setIor(IorState(5, false));
  }
  IorOcTreeNode* leaf = tree.findFinestLeaf({32768, 32768, 32768});
  leaf->setIor(IorState(20, true));
  const std::size_t size = tree.size();
  tree.setNow(Tick{19});
  tree.prune();
  EXPECT_EQ(tree.size(), size);
  EXPECT_NE(tree.search(octomap::OcTreeKey(32768, 32768, 32768))->ior(), IorState{});
  tree.setNow(Tick{20});
  tree.prune();
  EXPECT_EQ(tree.size(), size - 8);
  EXPECT_TRUE(wasAttended(tree.search(octomap::OcTreeKey(32768, 32768, 32768))->ior()));
}

TEST(IorOcTree, PruningKeepsApartWhatWasAttendedOnceAndWhatNeverWas) {
  IorOcTree tree(kLeafSize_m);
  for (unsigned short i = 0; i < 8; ++i) {
    const auto part = [i](int axis) { return static_cast<octomap::key_type>(32768 + (i >> axis & 1)); };
    tree.setNodeValue(octomap::OcTreeKey(part(0), part(1), part(2)), 3.0f);
  }
  tree.findFinestLeaf({32768, 32768, 32768})->setIor(IorState(20, true));
  tree.setNow(Tick{1000});
  tree.prune();
  EXPECT_TRUE(wasAttended(tree.search(octomap::OcTreeKey(32768, 32768, 32768))->ior()));
  EXPECT_FALSE(wasAttended(tree.search(octomap::OcTreeKey(32769, 32768, 32768))->ior()));
}

TEST(IorOcTree, LeafThatTurnsFreeIsForgotten) {
  IorOcTree tree(kLeafSize_m);
  const octomap::OcTreeKey key(32768, 32768, 32768);
  tree.updateNode(key, true);
  IorOcTreeNode* leaf = tree.findFinestLeaf(key);
  leaf->setIor(IorState(90, true));
  LeafSurface surface;
  surface.observations = 4;
  leaf->setSurface(surface);
  tree.updateNode(key, false);
  EXPECT_EQ(tree.search(key)->ior(), IorState(90, true)) << "still occupied";
  tree.updateNode(key, false);
  tree.updateNode(key, false);
  ASSERT_FALSE(tree.isNodeOccupied(tree.search(key)));
  EXPECT_EQ(tree.search(key)->ior(), IorState{});
  EXPECT_EQ(tree.search(key)->surface(), LeafSurface{});
  EXPECT_FALSE(tree.getRoot()->ior().flag());
}

TEST(IorOcTree, NeverHoldsLogOddsOfZeroAfterAnUpdate) {
  IorOcTree tree(kLeafSize_m);
  const octomap::OcTreeKey key(32768, 32768, 32768);
  tree.updateNode(key, 0.5f);
  tree.updateNode(key, -0.5f);
  EXPECT_LT(tree.search(key)->getLogOdds(), 0.0f);
  EXPECT_FALSE(tree.isNodeOccupied(tree.search(key)));
  tree.updateNode(key, 1.0f);
  tree.updateNode(key, -2.0f);
  tree.updateNode(key, 1.0f);
  EXPECT_NE(tree.search(key)->getLogOdds(), 0.0f);
}

TEST(IorOcTree, CoarseLeafIsSplitBeforeItsFinestLeafIsHandedOut) {
  IorOcTree tree(kLeafSize_m);
  tree.ensureRoot()->setLogOdds(-1.0f);
  IorOcTreeNode* leaf = tree.findFinestLeaf({1, 2, 3});
  ASSERT_NE(leaf, nullptr);
  EXPECT_EQ(leaf->getLogOdds(), -1.0f);
  EXPECT_EQ(tree.size(), 1u + 16 * 8);
  EXPECT_EQ(tree.search(octomap::OcTreeKey(1, 2, 3)), leaf);
}

TEST(IorOcTree, DeletingSubtreesAndSwappingKeepsTheCountsRight) {
  IorOcTree tree(kLeafSize_m), other(kLeafSize_m);
  fillRandomly(tree, 21, 3000);
  const std::size_t before = tree.size();
  tree.deleteNode(octomap::OcTreeKey(32768, 32768, 32768), 13);
  EXPECT_LT(tree.size(), before);
  EXPECT_EQ(tree.size(), tree.calcNumNodes());
  const std::size_t after = tree.size();
  other.swapContent(tree);
  EXPECT_EQ(other.size(), after);
  EXPECT_EQ(other.calcNumNodes(), after);
  EXPECT_EQ(tree.size(), 0u);
  fillRandomly(tree, 22, 100);
  tree.clear();
  EXPECT_EQ(tree.size(), 0u);
  fillRandomly(tree, 22, 100);
  EXPECT_EQ(tree.size(), tree.calcNumNodes());
}

}  // namespace
}  // namespace saccade
