#include "saccade/exchange/map_merge.hpp"

#include <random>

#include <gtest/gtest.h>

#include "saccade/exchange/map_difference.hpp"
#include "saccade/map/ior_octree.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

constexpr int kOrigin = MapTree::kCentreKey;

IorMap randomMap(unsigned seed, std::uint32_t tick) {
  IorMap map;
  std::mt19937 random(seed);
  test::fillRandomly(map.tree(), random, 20, 400);
  map.setNow({tick});
  map.tree().prune();
  return map;
}

/// Makes the leaves of a box occupied or free; coordinates in leaves from the world's origin, the end excluded.
void fill(IorMap& map, const Eigen::Vector3i& from, const Eigen::Vector3i& to, bool occupied, IorState ior = {}) {
  for (int x = from.x(); x < to.x(); ++x) {
    for (int y = from.y(); y < to.y(); ++y) {
      for (int z = from.z(); z < to.z(); ++z) {
        test::setLeaf(map.tree(), kOrigin + x, kOrigin + y, kOrigin + z, occupied);
        if (occupied) map.tree().findFinestLeaf(test::octoKey(kOrigin + x, kOrigin + y, kOrigin + z))->setIor(ior);
      }
    }
  }
  map.tree().updateInnerNodes();
}

MapLeaf leafAt(const IorMap& map, int x, int y, int z) {
  const auto leaf =
      map.findLeaf(LeafKey{static_cast<std::uint16_t>(kOrigin + x), static_cast<std::uint16_t>(kOrigin + y),
                           static_cast<std::uint16_t>(kOrigin + z)});
  EXPECT_TRUE(leaf.has_value());
  return leaf.value_or(MapLeaf{});
}

TEST(MergeMaps, WithAnEmptyMapEitherWayRoundIsTheMapItself) {
  const IorMap map = randomMap(1, 17), empty;
  for (const IorMap& merged : {mergeMaps(map, empty), mergeMaps(empty, map)}) {
    EXPECT_TRUE(merged.tree() == map.tree());
    EXPECT_EQ(merged.now(), map.now());
  }
}

TEST(MergeMaps, IsSymmetric) {
  const IorMap a = randomMap(2, 17), b = randomMap(3, 30);
  EXPECT_TRUE(mergeMaps(a, b).tree() == mergeMaps(b, a).tree());
}

TEST(MergeMaps, AddsLogOddsAndClampsThem) {
  IorMap a, b;
  fill(a, {0, 0, 0}, {1, 1, 1}, true);   // 2
  fill(b, {0, 0, 0}, {1, 1, 1}, true);   // 2
  fill(a, {3, 0, 0}, {4, 1, 1}, true);   // 2
  fill(b, {3, 0, 0}, {4, 1, 1}, false);  // -2
  fill(b, {6, 0, 0}, {7, 1, 1}, false);  // unknown in a
  const IorMap merged = mergeMaps(a, b);
  EXPECT_FLOAT_EQ(leafAt(merged, 0, 0, 0).log_odds, merged.tree().getClampingThresMaxLog());  // of 4
  EXPECT_FALSE(leafAt(merged, 3, 0, 0).occupied);  // cancelled out, which must not read as occupied
  EXPECT_FLOAT_EQ(leafAt(merged, 6, 0, 0).log_odds, -2.0f);
}

TEST(MergeMaps, KeepsTheLongerRemainingMemoryCountedFromTheMergedNow) {
  IorMap a, b;
  a.setNow({10});
  b.setNow({100});
  fill(a, {0, 0, 0}, {1, 1, 1}, true, IorState(15, true));    // 5 ticks left
  fill(b, {0, 0, 0}, {1, 1, 1}, true, IorState(103, false));  // 3 ticks left
  fill(a, {3, 0, 0}, {4, 1, 1}, true, IorState(12, false));   // 2 left
  fill(b, {3, 0, 0}, {4, 1, 1}, true, IorState(102, true));   // 2 left, inhibited
  fill(a, {6, 0, 0}, {7, 1, 1}, true, IorState(9, true));     // forgotten
  fill(b, {6, 0, 0}, {7, 1, 1}, true);
  const IorMap merged = mergeMaps(a, b);
  EXPECT_EQ(merged.now(), Tick{110});
  EXPECT_EQ(leafAt(merged, 0, 0, 0).ior, IorState(115, true));
  EXPECT_EQ(leafAt(merged, 3, 0, 0).ior, IorState(112, true));
  EXPECT_EQ(weight(leafAt(merged, 6, 0, 0).ior, merged.now()), 0U);
  EXPECT_TRUE(isFamiliar(leafAt(merged, 6, 0, 0).ior, merged.now())) << "it was attended once";
}

TEST(MergeMaps, LiftsInhibitionWhereTheSceneChangedUnderIt) {
  IorMap a, b;
  fill(a, {0, 0, 0}, {2, 2, 2}, true, IorState(50, true));
  for (int i = 0; i < 2; ++i) {  // seen twice as surely: the sum stays occupied
    for (int x = 0; x < 2; ++x) {
      a.tree().updateNode(test::octoKey(kOrigin + x, kOrigin, kOrigin), 0.7f);
    }
  }
  fill(b, {0, 0, 0}, {1, 2, 2}, false);                     // free there now
  fill(b, {1, 0, 0}, {2, 2, 2}, true, IorState(20, true));  // still there
  MapMergeReport report;
  const IorMap merged = mergeMaps(a, b, &report);
  EXPECT_TRUE(leafAt(merged, 0, 0, 0).occupied);
  EXPECT_EQ(weight(leafAt(merged, 0, 0, 0).ior, merged.now()), 0U);
  EXPECT_TRUE(inhibited(leafAt(merged, 1, 0, 0).ior, merged.now()));
  EXPECT_EQ(report.lifted, 4U);
}

TEST(MergeMaps, RefusesLeavesOfDifferentSize) {
  IorMapConfig coarse;
  coarse.leaf_size_m = 0.02;
  EXPECT_THROW(mergeMaps(IorMap(), IorMap(coarse)), std::invalid_argument);
  EXPECT_THROW(compareMaps(IorMap(), IorMap(coarse)), std::invalid_argument);
}

TEST(ResampleMap, ByTheIdentityIsTheMapItself) {
  const IorMap map = randomMap(4, 17);
  EXPECT_TRUE(resampleMap(map, Pose::Identity(), map.config()).tree() == map.tree());
}

TEST(ResampleMap, ByWholeLeavesThereAndBackIsTheMapItself) {
  const IorMap map = randomMap(5, 17);
  Pose shift = Pose::Identity();
  shift.translation() = Eigen::Vector3d(0.07, -0.33, 0.11);
  shift.linear() = Eigen::AngleAxisd(3.14159265358979323846 / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const IorMap moved = resampleMap(map, shift, map.config());
  EXPECT_FALSE(moved.tree() == map.tree());
  IorMap back = resampleMap(moved, shift.inverse(), map.config());
  EXPECT_TRUE(back.tree() == map.tree());
}

TEST(ResampleMap, AWallStaysAWallUnderAnyTurn) {
  IorMap map;
  fill(map, {0, -30, -30}, {2, 30, 30}, true);
  fill(map, {-20, -30, -30}, {0, 30, 30}, false);
  Pose turn = Pose::Identity();
  turn.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  turn.translation() = Eigen::Vector3d(0.123, 0.456, -0.789);
  const IorMap moved = resampleMap(map, turn, map.config());
  for (int i = -25; i <= 25; i += 5) {  // points within the wall and before it, away from the edges
    const Eigen::Vector3d within(0.01, 0.01 * i, 0.0), before(-0.1, 0.01 * i, 0.0);
    const auto wall = moved.findLeaf(turn * within), air = moved.findLeaf(turn * before);
    ASSERT_TRUE(wall && air);
    EXPECT_TRUE(wall->occupied);
    EXPECT_FALSE(air->occupied);
  }
}

/// A floor, and a block on it whose lowest corner is at x, with free space above.
IorMap floorWithBlock(int x) {
  IorMap map;
  fill(map, {-40, -10, 0}, {40, 10, 12}, false);
  fill(map, {-40, -10, -1}, {40, 10, 0}, true);
  fill(map, {x, -3, 0}, {x + 6, 3, 6}, true);
  return map;
}

TEST(CompareMaps, ABlockThatMovedIsFoundWithItsWay) {
  const IorMap before = floorWithBlock(-20), after = floorWithBlock(10);
  const MapDifference difference = compareMaps(before, after);
  ASSERT_EQ(difference.gone.size(), 1U);
  ASSERT_EQ(difference.appeared.size(), 1U);
  ASSERT_EQ(difference.moved.size(), 1U);
  const Eigen::Vector3d way = difference.appeared[0].mean_W - difference.gone[0].mean_W;
  constexpr double kLeaf_m = 0.01;
  EXPECT_NEAR(way.x(), 0.30, kLeaf_m);
  EXPECT_NEAR(way.y(), 0.0, kLeaf_m);
  EXPECT_NEAR(way.z(), 0.0, kLeaf_m);
}

TEST(CompareMaps, AMapHasNotChangedAgainstItselfNorByAShiftWithinTheTolerance) {
  const IorMap map = randomMap(6, 17);
  const MapDifference same = compareMaps(map, map);
  EXPECT_TRUE(same.gone.empty() && same.appeared.empty() && same.moved.empty());
  EXPECT_EQ(same.only_a + same.only_b, 0U);
  EXPECT_TRUE(same.attention_gained.empty());
  const MapDifference shifted = compareMaps(floorWithBlock(0), floorWithBlock(1));
  EXPECT_TRUE(shifted.gone.empty() && shifted.appeared.empty());
  MapDifferenceConfig strict;
  strict.tolerance_leaves = 0;
  EXPECT_FALSE(compareMaps(floorWithBlock(0), floorWithBlock(1), strict).gone.empty());
}

TEST(CompareMaps, WhatOnlyOneMapHasSeenHasNotChanged) {
  IorMap before = floorWithBlock(0), after = floorWithBlock(0);
  fill(after, {-40, 40, 0}, {-30, 50, 10}, true);
  const MapDifference difference = compareMaps(before, after);
  EXPECT_TRUE(difference.appeared.empty());
  EXPECT_EQ(difference.only_b, 1000U);
}

TEST(CompareMaps, TellsWhereAttentionWasGained) {
  IorMap before = floorWithBlock(0), after = floorWithBlock(0);
  fill(after, {0, -3, 0}, {6, 3, 6}, true, IorState(9, true));
  const MapDifference difference = compareMaps(before, after);
  EXPECT_EQ(difference.attention_gained.size(), 216U);
  EXPECT_EQ(difference.inhibited_a, 0U);
  EXPECT_EQ(difference.inhibited_b, 216U);
}

}  // namespace
}  // namespace saccade
