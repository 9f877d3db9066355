#include "reporting/reduced_map.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/ior_trees.hpp"

namespace saccade {
namespace {

using test::setLeaf;

constexpr int kCentre = MapTree::kCentreKey;
constexpr double kLeafSize_m = 0.05;

/// A point of a reduced map, unpacked as the page's script does it.
struct Point {
  Eigen::Vector3d p_W;
  int red, green, blue;
  bool inhibited;
  double weight;  ///< ticks
  Eigen::Vector3d normal;
  double edge_m;
};

Point pointOf(const ReducedMap& map, std::size_t i) {
  const std::uint8_t* bytes = map.bytes.data() + i * ReducedMap::kPointBytes;
  Point point;
  for (int axis = 0; axis < 3; ++axis) {
    point.p_W[axis] = map.origin_W[axis] + 0.5 * map.cell_m * (bytes[2 * axis] + 256 * bytes[2 * axis + 1]);
  }
  point.red = bytes[6];
  point.green = bytes[7];
  point.blue = bytes[8];
  point.inhibited = (bytes[9] & 128) != 0;
  point.weight = (bytes[9] & 127) / 127.0 * map.largest_weight;
  const Eigen::Vector2d o =
      Eigen::Vector2d(static_cast<std::int8_t>(bytes[10]), static_cast<std::int8_t>(bytes[11])) / 127.0;
  point.normal = {o.x(), o.y(), 1.0 - std::abs(o.x()) - std::abs(o.y())};
  if (point.normal.z() < 0.0) {
    point.normal.x() = (1.0 - std::abs(o.y())) * (o.x() < 0.0 ? -1.0 : 1.0);
    point.normal.y() = (1.0 - std::abs(o.x())) * (o.y() < 0.0 ? -1.0 : 1.0);
  }
  point.normal.normalize();
  point.edge_m = map.cell_m * (1 << bytes[12]);
  return point;
}

void setLeafWith(IorOcTree& tree, int x, int y, int z, IorState ior, std::uint8_t red, const Eigen::Vector3f& normal) {
  setLeaf(tree, kCentre + x, kCentre + y, kCentre + z, true);
  IorOcTreeNode* leaf = tree.findFinestLeaf(test::octoKey(kCentre + x, kCentre + y, kCentre + z));
  leaf->setIor(ior);
  LeafSurface surface;
  surface.red = red;
  surface.setNormal(normal);
  leaf->setSurface(surface);
}

TEST(ReducedMap, AMapThatIsSmallEnoughKeepsEveryLeaf) {
  IorOcTree tree(kLeafSize_m);
  const Eigen::Vector3f normal = Eigen::Vector3f(0.3f, -0.8f, -0.5f).normalized();
  setLeafWith(tree, -3, 5, 7, IorState(30, true), 200, normal);
  setLeafWith(tree, 4, 5, 7, IorState(0, false), 100, -normal);
  tree.setNow(Tick{10});
  tree.updateInnerNodes();
  const ReducedMap reduced = reduceMap(tree.view(), 10);
  ASSERT_EQ(reduced.pointCount(), 2u);
  EXPECT_DOUBLE_EQ(reduced.cell_m, kLeafSize_m);
  EXPECT_EQ(reduced.largest_weight, 20u);
  const Point point = pointOf(reduced, 0);
  EXPECT_NEAR((point.p_W - Eigen::Vector3d(-2.5, 5.5, 7.5) * kLeafSize_m).norm(), 0.0, 1e-9);
  EXPECT_EQ(point.red, 200);
  EXPECT_TRUE(point.inhibited);
  EXPECT_DOUBLE_EQ(point.weight, 20.0);
  constexpr double kNormalSteps = 0.03;  // of 1 / 127, twice
  EXPECT_NEAR((point.normal - normal.cast<double>()).norm(), 0.0, kNormalSteps);
  EXPECT_NEAR((pointOf(reduced, 1).normal + normal.cast<double>()).norm(), 0.0, kNormalSteps);
  EXPECT_FALSE(pointOf(reduced, 1).inhibited);
}

TEST(ReducedMap, JoinedLeavesHaveTheMeanColourAndTheStrongestMemory) {
  IorOcTree tree(kLeafSize_m);
  setLeafWith(tree, 0, 0, 0, IorState(30, true), 200, {0, 0, 1});
  setLeafWith(tree, 1, 0, 0, IorState(15, false), 100, {0, 0, 1});
  tree.setNow(Tick{10});
  tree.updateInnerNodes();
  const ReducedMap reduced = reduceMap(tree.view(), 1);
  ASSERT_EQ(reduced.pointCount(), 1u);
  const Point point = pointOf(reduced, 0);
  EXPECT_EQ(point.red, 150);
  EXPECT_TRUE(point.inhibited);
  EXPECT_DOUBLE_EQ(point.weight, 20.0);
  EXPECT_DOUBLE_EQ(point.edge_m, 2 * kLeafSize_m);
}

TEST(ReducedMap, NeverHasMorePointsThanAskedForAndEachOccupiedLeafLiesInOne) {
  std::mt19937 random(7);
  IorOcTree tree(kLeafSize_m);
  test::fillRandomly(tree, random, 200, 3000);
  for (const std::size_t most : {1u, 50u, 400u, 1'000'000u}) {
    const ReducedMap reduced = reduceMap(tree.view(), most);
    ASSERT_LE(reduced.pointCount(), most);
    std::vector<Point> points;
    for (std::size_t i = 0; i < reduced.pointCount(); ++i) points.push_back(pointOf(reduced, i));
    int checked = 0;
    for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs() && checked < 200; ++leaf) {
      if (!tree.isNodeOccupied(*leaf)) continue;
      const Eigen::Vector3d centre(leaf.getX(), leaf.getY(), leaf.getZ());
      EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const Point& point) {
        return (point.p_W - centre).lpNorm<Eigen::Infinity>() < 0.5 * point.edge_m;
      })) << most;
      ++checked;
    }
    EXPECT_GT(checked, 100);
  }
}

TEST(ReducedMap, LeavesAtBothEndsOfTheKeySpaceStillFitTheBytes) {
  IorOcTree tree(kLeafSize_m);
  setLeaf(tree, 0, 0, 0, true);
  setLeaf(tree, 65535, 65535, 65535, true);
  tree.updateInnerNodes();
  const ReducedMap reduced = reduceMap(tree.view(), 100);
  ASSERT_EQ(reduced.pointCount(), 2u);
  const double reach_m = kCentre * kLeafSize_m;
  EXPECT_NEAR(pointOf(reduced, 0).p_W.x(), -reach_m, reduced.cell_m);
  EXPECT_NEAR(pointOf(reduced, 1).p_W.z(), reach_m, reduced.cell_m);
}

TEST(ReducedMap, OfNothingOccupiedIsEmpty) {
  IorOcTree tree(kLeafSize_m);
  EXPECT_EQ(reduceMap(tree.view(), 10).pointCount(), 0u);
  setLeaf(tree, kCentre, kCentre, kCentre, false);
  tree.updateInnerNodes();
  EXPECT_EQ(reduceMap(tree.view(), 10).pointCount(), 0u);
}

}  // namespace
}  // namespace saccade
