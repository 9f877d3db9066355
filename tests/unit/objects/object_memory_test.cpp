#include "saccade/objects/object_memory.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "saccade/map/ior_octree.hpp"
#include "saccade/objects/object_history.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

constexpr int kOrigin = MapTree::kCentreKey;

/// The leaves of a cube with its lowest corner at (x, 0, 0), in leaves from the world's origin.
std::vector<LeafKey> cube(int x, int edge) {
  std::vector<LeafKey> leaves;
  for (int i = 0; i < edge * edge * edge; ++i) {
    leaves.push_back({static_cast<std::uint16_t>(kOrigin + x + i % edge),
                      static_cast<std::uint16_t>(kOrigin + i / edge % edge),
                      static_cast<std::uint16_t>(kOrigin + i / (edge * edge))});
  }
  return leaves;
}

ObjectId look(ObjectMemory& memory, std::uint32_t tick, int rank, const std::vector<LeafKey>& leaves) {
  return memory.observe({tick}, {static_cast<std::int64_t>(tick)}, {rank, leaves});
}

TEST(ObjectMemory, CandidatesThatReturnOnTheSameLeavesAreOneObject) {
  ObjectMemory memory;
  const ObjectId a = look(memory, 0, 0, cube(0, 8));
  const ObjectId b = look(memory, 0, 1, cube(40, 8));
  EXPECT_NE(a, b);
  EXPECT_EQ(look(memory, 1, 0, cube(41, 8)), b);  // as another pose sees it
  EXPECT_EQ(look(memory, 2, 0, cube(0, 8)), a);
  const std::vector<AttendedObject> objects = memory.objects();
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[0].id, a);
  ASSERT_EQ(objects[0].looks.size(), 2U);
  EXPECT_EQ(objects[0].looks[1].tick, Tick{2});
}

TEST(ObjectMemory, APartAndItsWholeAreTwoObjects) {
  ObjectMemory memory;
  for (std::uint32_t tick = 0; tick < 3; ++tick) {
    const ObjectId whole = look(memory, tick, 0, cube(0, 16));
    const ObjectId part = look(memory, tick, 1, cube(0, 8));
    EXPECT_NE(whole, part);
  }
  EXPECT_EQ(memory.objects().size(), 2U);
}

TEST(ObjectMemory, TwoCandidatesOfOneTickAreOneLook) {
  ObjectMemory memory;
  for (std::uint32_t tick = 0; tick < 2; ++tick) {
    const ObjectId first = look(memory, tick, 0, cube(0, 8));
    EXPECT_EQ(look(memory, tick, 1, cube(0, 8)), first);
  }
  ASSERT_EQ(memory.objects().size(), 1U);
  EXPECT_EQ(memory.objects()[0].looks.size(), 2U);
}

TEST(ObjectMemory, WhatWasSeenOnceIsNoObjectYet) {
  ObjectMemory memory;
  look(memory, 0, 0, cube(0, 8));
  EXPECT_TRUE(memory.objects().empty());
  EXPECT_EQ(memory.objects(1).size(), 1U);
}

TEST(ObjectMemory, BlocksThatFewLooksCoveredDoNotBelongToTheObject) {
  ObjectMemory memory;
  std::vector<LeafKey> with_stray = cube(0, 8);
  with_stray.push_back({0, 0, 0});
  look(memory, 0, 0, with_stray);
  for (std::uint32_t tick = 1; tick < 5; ++tick) look(memory, tick, 0, cube(0, 8));
  ASSERT_EQ(memory.objects().size(), 1U);
  EXPECT_EQ(memory.objects()[0].blocks.size(), 64U);
  EXPECT_EQ(memory.objects()[0].bestView().tick, Tick{0});  // which covered one block more
}

TEST(ObjectMemory, GoingOnWithALogFindsTheSameNumbersAgain) {
  AttendLog log;
  const std::vector<LeafKey> places[] = {cube(0, 6), cube(20, 6), cube(40, 6), cube(60, 6)};
  std::vector<AttendedObject> before;
  for (std::uint32_t tick = 0; tick < 12; ++tick) {
    const CandidateLeaves candidates[] = {{0, places[tick % 4]}, {1, places[(tick + 1) % 4]}};
    log.record({{tick}, {static_cast<std::int64_t>(tick)}, {}, {}}, candidates);
    if (tick == 6) before = findObjects(log);
  }
  const std::vector<AttendedObject> after = findObjects(log);
  ASSERT_EQ(before.size(), 4U);
  ASSERT_EQ(after.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(before[i].id, after[i].id);
    EXPECT_EQ(before[i].blocks, after[i].blocks);
  }
}

TEST(ObjectMemory, AnObjectsLeavesAreTheOccupiedOnesOfTheMapAndItsBoxIsAroundThem) {
  IorMap map;
  ObjectMemory memory;
  for (std::uint32_t tick = 0; tick < 2; ++tick) look(memory, tick, 0, cube(0, 4));
  for (const LeafKey& key : cube(0, 4)) test::setLeaf(map.tree(), key.x, key.y, key.z, key.z < kOrigin + 2);
  const std::vector<LeafKey> leaves = leavesOf(memory.objects()[0], map);
  EXPECT_EQ(leaves.size(), 32U);
  const Eigen::AlignedBox3d box = boxOf(leaves, 0.01);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3d::Zero()));
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3d(0.04, 0.04, 0.02)));
}

TEST(ObjectHistory, SaysWhenFlagsCameOnAndWhenTheyGo) {
  IorMapConfig config;
  config.ior = {3, 6.0};
  config.attend_blocks = false;
  IorMap map(config);
  const std::vector<LeafKey> leaves = cube(0, 4);
  for (const LeafKey& key : leaves) test::setLeaf(map.tree(), key.x, key.y, key.z, true);
  AttendLog log;
  for (std::uint32_t tick = 0; tick < 4; ++tick) {  // the limit is reached in the third tick
    const CandidateLeaves candidates[] = {{0, leaves}};
    const AttentionReport report = map.attend(leaves);
    log.record({{tick}, {static_cast<std::int64_t>(tick)}, report.flags_on, {}}, candidates);
  }
  const std::vector<AttendedObject> objects = findObjects(log);
  ASSERT_EQ(objects.size(), 1U);
  const ObjectHistory history = historyOf(objects[0], log, map);
  ASSERT_EQ(history.flags_on.size(), 1U);
  EXPECT_EQ(history.flags_on[0].tick, Tick{2});
  EXPECT_EQ(history.flags_on[0].leaves, 64);
  EXPECT_EQ(history.leaves, 64);
  EXPECT_EQ(history.inhibited, 64);
  // w = 1, 2, 3 * 6, 19: forgotten 19 ticks after the fourth
  EXPECT_EQ(history.next_expiry, 4U + 19U);
  EXPECT_EQ(history.last_expiry, 4U + 19U);
  for (int tick = 0; tick < 19; ++tick) map.attend({});
  EXPECT_EQ(historyOf(objects[0], log, map).inhibited, 0);
}

}  // namespace
}  // namespace saccade
