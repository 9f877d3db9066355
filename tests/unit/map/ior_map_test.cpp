#include "saccade/map/ior_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "saccade/map/ior_octree.hpp"
#include "unit/map/octomap_parity.hpp"

namespace saccade {
namespace {

constexpr double kLeafSize_m = 0.05;

IorMapConfig coarseConfig() {
  IorMapConfig config;
  config.leaf_size_m = kLeafSize_m;
  config.ior.ior_limit = 2;
  config.ior.mf = 3;
  config.attend_blocks = false;
  return config;
}

/// A wall across the view.
DepthMaps wall(float depth_m, int width = 80, int height = 60) {
  DepthMaps maps;
  maps.camera = {width, height, 80.0, 80.0, (width - 1) / 2.0, (height - 1) / 2.0};
  maps.depth_m = cv::Mat1f(height, width, depth_m);
  return maps;
}

Pose poseAt(double x, double y, double z) {
  Pose T_WC = Pose::Identity();
  T_WC.translation() = Eigen::Vector3d(x, y, z);
  return T_WC;
}

std::vector<LeafKey> occupiedKeys(const IorMap& map) {
  std::vector<LeafKey> keys;
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (leaf.occupied && leaf.key.depth == MapTree::kDepth) keys.push_back(leaf.key.corner);
  });
  return keys;
}

TEST(IorMap, SeesAWallAsOccupiedTheSpaceBeforeItAsFreeAndTheSpaceBehindAsUnknown) {
  IorMap map(coarseConfig());
  const IntegrationReport report = map.integrate(wall(1.02f), {}, Pose::Identity());
  EXPECT_EQ(report.points, 80 * 60);
  EXPECT_EQ(report.dropped_points, 0);
  EXPECT_EQ(map.occupiedLeafCount(), static_cast<std::size_t>(report.hit_leaves));
  ASSERT_TRUE(map.findLeaf(Eigen::Vector3d(0, 0, 1.02)));
  EXPECT_TRUE(map.findLeaf(Eigen::Vector3d(0, 0, 1.02))->occupied);
  for (const double z : {0.01, 0.3, 0.7, 0.99}) {
    const auto leaf = map.findLeaf(Eigen::Vector3d(0.001, 0.001, z));
    ASSERT_TRUE(leaf) << z;
    EXPECT_FALSE(leaf->occupied) << z;
  }
  EXPECT_FALSE(map.findLeaf(Eigen::Vector3d(0, 0, 1.06)));
  EXPECT_FALSE(map.findLeaf(Eigen::Vector3d(0, 0, -0.06)));
  EXPECT_FALSE(map.findLeaf(Eigen::Vector3d(2, 0, 0.5)));
}

TEST(IorMap, PutsColourNormalAndCountIntoTheLeavesHit) {
  IorMap map(coarseConfig());
  DepthMaps maps = wall(1.02f);
  maps.normals = cv::Mat3f(maps.depth_m.size(), cv::Vec3f(0, 0, -1));
  const cv::Mat3b color(maps.depth_m.size(), cv::Vec3b(10, 100, 200));
  for (int i = 0; i < 3; ++i) map.integrate(maps, color, Pose::Identity());
  const LeafSurface surface = map.findLeaf(Eigen::Vector3d(0, 0, 1.02))->surface;
  EXPECT_EQ(surface.observations, 3);
  EXPECT_EQ(surface.blue, 10);
  EXPECT_EQ(surface.green, 100);
  EXPECT_EQ(surface.red, 200);
  EXPECT_EQ(surface.normal(), Eigen::Vector3f(0, 0, -1));
}

TEST(IorMap, FramesWithoutAnyMeasurementLeaveTheMapEmpty) {
  IorMap map(coarseConfig());
  for (const float depth :
       {0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0f, 0.29f, 4.01f}) {
    EXPECT_EQ(map.integrate(wall(depth), {}, Pose::Identity()).points, 0) << depth;
  }
  EXPECT_EQ(map.integrate(DepthMaps{}, {}, Pose::Identity()).points, 0);
  EXPECT_EQ(map.nodeCount(), 0u);
  EXPECT_FALSE(map.view().root);
}

TEST(IorMap, IgnoresNanPixelsButUsesTheOthers) {
  IorMap map(coarseConfig()), with_holes(coarseConfig());
  DepthMaps zero = wall(1.02f), nan = wall(1.02f);
  for (int v = 10; v < 40; ++v) {
    for (int u = 20; u < 50; ++u) {
      zero.depth_m(v, u) = 0.0f;
      nan.depth_m(v, u) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  map.integrate(zero, {}, Pose::Identity());
  with_holes.integrate(nan, {}, Pose::Identity());
  EXPECT_GT(map.leafCount(), 0u);
  EXPECT_TRUE(map.tree() == with_holes.tree());
}

TEST(IorMap, RefusesImagesOfAnotherSizeAndPosesThatAreNotFinite) {
  IorMap map(coarseConfig());
  DepthMaps maps = wall(1.0f);
  EXPECT_THROW(map.integrate(maps, cv::Mat3b(10, 10), Pose::Identity()), std::invalid_argument);
  EXPECT_THROW(map.integrate(maps, {}, poseAt(std::nan(""), 0, 0)), std::invalid_argument);
  maps.camera.width = 81;
  EXPECT_THROW(map.integrate(maps, {}, Pose::Identity()), std::invalid_argument);
  IorMapConfig config;
  config.leaf_size_m = 0.0;
  EXPECT_THROW(IorMap{config}, std::invalid_argument);
}

TEST(IorMap, DropsAndCountsPointsOutsideTheKeySpaceInsteadOfWrapping) {
  const double edge_m = 32768 * kLeafSize_m;
  IorMap map(coarseConfig());
  const auto inside = map.integrate(wall(1.02f), {}, poseAt(0, 0, edge_m - 1.5));
  EXPECT_EQ(inside.dropped_points, 0);
  const auto half = map.integrate(wall(1.02f), {}, poseAt(edge_m, 0, 0));
  EXPECT_GT(half.dropped_points, 0);
  EXPECT_LT(half.dropped_points, half.points);
  const std::size_t leaves = map.leafCount();
  const auto beyond = map.integrate(wall(1.02f), {}, poseAt(0, 0, edge_m - 0.5));
  EXPECT_EQ(beyond.dropped_points, beyond.points);
  for (const double far_m : {1e4, -1e4, 1e12, -1e12}) {
    const auto far = map.integrate(wall(1.02f), {}, poseAt(far_m, 0, 0));
    EXPECT_EQ(far.dropped_points, far.points) << far_m;
  }
  EXPECT_EQ(map.leafCount(), leaves);
  map.forEachLeaf([&](const MapLeaf& leaf) { ASSERT_GT(leaf.key.corner.z, 32700) << "wrapped around"; });
}

TEST(IorMap, CameraInsideAnOccupiedLeafFreesItAndGoesOn) {
  IorMap map(coarseConfig());
  map.integrate(wall(1.02f), {}, Pose::Identity());
  const Eigen::Vector3d p(0.01, 0.01, 1.02);
  ASSERT_TRUE(map.findLeaf(p)->occupied);
  for (int i = 0; i < 5; ++i) map.integrate(wall(1.02f), {}, poseAt(p.x(), p.y(), p.z()));
  EXPECT_FALSE(map.findLeaf(p)->occupied);
  EXPECT_TRUE(map.findLeaf(Eigen::Vector3d(0.01, 0.01, 2.04))->occupied);
}

TEST(IorMap, AttendsEachLeafOnceATickAndFlagsItAtTheLimit) {
  IorMap map(coarseConfig());
  map.integrate(wall(1.02f), {}, Pose::Identity());
  const LeafKey key = *map.keyAt(Eigen::Vector3d(0, 0, 1.02));
  const LeafKey unknown{1, 2, 3};
  const LeafKey free = *map.keyAt(Eigen::Vector3d(0.001, 0.001, 0.5));
  AttentionReport report = map.attend(std::vector<LeafKey>{key, unknown, key, free, key});
  EXPECT_EQ(report.tick, Tick{0});
  EXPECT_EQ(map.now(), Tick{1});
  EXPECT_EQ(report.attended, 1);
  EXPECT_EQ(report.missing, 2);
  EXPECT_TRUE(report.flags_on.empty());
  EXPECT_EQ(weight(map.findLeaf(key)->ior, map.now()), 1u);
  report = map.attend(std::vector<LeafKey>{key});
  EXPECT_EQ(report.flags_on, std::vector<LeafKey>{key});
  EXPECT_EQ(weight(map.findLeaf(key)->ior, map.now()), 6u);
  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(inhibited(map.findLeaf(key)->ior, map.now()));
    EXPECT_TRUE(inhibited(map.view().root.ior(), map.now())) << "the root says that an inhibited leaf is below";
    map.attend({});
  }
  EXPECT_FALSE(inhibited(map.findLeaf(key)->ior, map.now()));
  EXPECT_FALSE(inhibited(map.view().root.ior(), map.now()));
}

TEST(IorMap, AttendsTheOccupiedLeavesOfABlockTogetherAndOnceATick) {
  IorMapConfig config = coarseConfig();
  config.attend_blocks = true;
  IorMap map(config);
  // A wall that cuts through its leaves at a slant: blocks are partly occupied.
  DepthMaps slanted = wall(1.0f);
  for (int u = 0; u < slanted.depth_m.cols; ++u) slanted.depth_m.col(u) = 1.0f + 0.005f * static_cast<float>(u);
  map.integrate(slanted, {}, Pose::Identity());
  const std::vector<LeafKey> occupied = occupiedKeys(map);
  const auto sameBlock = [](const LeafKey& a, const LeafKey& b) {
    return a.x / 2 == b.x / 2 && a.y / 2 == b.y / 2 && a.z / 2 == b.z / 2;
  };
  // Looking at one leaf and at another of the same block is one look at the block.
  const LeafKey first = occupied[occupied.size() / 2];
  std::vector<LeafKey> block;
  for (const LeafKey& key : occupied) {
    if (sameBlock(key, first)) block.push_back(key);
  }
  ASSERT_GT(block.size(), 1u);
  ASSERT_LT(block.size(), 8u);
  const AttentionReport report = map.attend(std::vector<LeafKey>{block.front(), block.back()});
  EXPECT_EQ(report.attended, static_cast<int>(block.size()));
  for (const LeafKey& key : occupied) {
    EXPECT_EQ(weight(map.findLeaf(key)->ior, map.now()), sameBlock(key, first) ? 1u : 0u);
  }
  EXPECT_EQ(map.attend(std::vector<LeafKey>{first}).flags_on, block);
}

/// The law leaf by leaf, each looked for from the root: the slow twin of IorMap::attend().
void attendOneByOne(IorMap& map, std::vector<LeafKey> keys, AttentionReport& report) {
  if (map.config().attend_blocks) {
    std::set<LeafKey> of_blocks;
    for (const LeafKey& key : keys) {
      for (unsigned i = 0; i < 8; ++i) {
        const auto part = [](std::uint16_t k, unsigned upper) { return static_cast<std::uint16_t>((k & ~1u) | upper); };
        of_blocks.insert({part(key.x, i & 1u), part(key.y, i >> 1 & 1u), part(key.z, i >> 2)});
      }
    }
    keys.assign(of_blocks.begin(), of_blocks.end());
  }
  const std::set<LeafKey> different(keys.begin(), keys.end());
  const Tick now = map.now();
  for (const LeafKey& key : different) {
    const auto known = map.findLeaf(key);
    if (!known || !known->occupied) {
      ++report.missing;
      continue;
    }
    IorOcTreeNode* leaf = map.tree().findFinestLeaf({key.x, key.y, key.z});
    leaf->setIor(attend(leaf->ior(), now, map.config().ior));
    ++report.attended;
    if (!inhibited(known->ior, now) && leaf->ior().flag()) report.flags_on.push_back(key);
  }
  map.tree().updateInnerNodes();
  map.setNow(Tick{now.value + 1});
}

TEST(IorMap, AttendsAsOneThatLooksForEachLeafByItself) {
  std::mt19937 random(7);
  for (const bool blocks : {false, true}) {
    IorMapConfig config = coarseConfig();
    config.attend_blocks = blocks;
    IorMap map(config), twin(config);
    for (IorMap* m : {&map, &twin}) m->integrate(wall(1.02f), {}, Pose::Identity());
    // An occupied leaf above the finest depth, which attention has to split.
    for (IorMap* m : {&map, &twin}) {
      for (std::uint16_t i = 0; i < 64; ++i) {
        const auto from = [](int corner, int step) { return static_cast<std::uint16_t>(corner + step); };
        m->tree().setNodeValue(octomap::OcTreeKey(from(32800, i & 3), from(32800, i >> 2 & 3), from(32800, i >> 4)),
                               3.0f);
      }
    }
    std::vector<LeafKey> some = occupiedKeys(map);
    some.push_back({32801, 32802, 32803});
    some.push_back({32768, 32768, 32770});  // free
    some.push_back({1, 2, 3});              // unknown
    int flags = 0;
    for (int tick = 0; tick < 8; ++tick) {
      std::vector<LeafKey> keys;
      for (const LeafKey& key : some) {
        for (auto times = random() % 3; times > 0; --times) keys.push_back(key);
      }
      std::shuffle(keys.begin(), keys.end(), random);
      const AttentionReport report = map.attend(keys);
      AttentionReport expected;
      attendOneByOne(twin, keys, expected);
      EXPECT_EQ(report.attended, expected.attended);
      EXPECT_EQ(report.missing, expected.missing);
      EXPECT_EQ(std::set(report.flags_on.begin(), report.flags_on.end()),
                std::set(expected.flags_on.begin(), expected.flags_on.end()));
      EXPECT_EQ(report.flags_on.size(), expected.flags_on.size());
      EXPECT_TRUE(map.tree() == twin.tree());
      flags += static_cast<int>(report.flags_on.size());
    }
    EXPECT_GT(flags, 100);
  }
}

TEST(IorMap, EveryInnerNodeAboveAnInhibitedLeafSaysSo) {
  IorMap map(coarseConfig());
  map.integrate(wall(1.02f), {}, Pose::Identity());
  std::vector<LeafKey> keys = occupiedKeys(map);
  ASSERT_GT(keys.size(), 50u);
  for (std::size_t i = 0; i < keys.size(); i += 7) {
    map.attend(std::vector<LeafKey>{keys[i]});
    map.attend(std::vector<LeafKey>{keys[i]});
  }
  map.integrate(wall(1.02f), {}, poseAt(0.02, 0, 0));
  const Tick now = map.now();
  const auto check = [&](const auto& self, MapNode node) -> bool {
    if (node.isLeaf()) return inhibited(node.ior(), now);
    bool any = false;
    for (unsigned i = 0; i < 8; ++i) {
      if ((node.childMask() >> i & 1u) != 0) any |= self(self, node.child(i));
    }
    EXPECT_TRUE(!any || inhibited(node.ior(), now));
    return any;
  };
  EXPECT_TRUE(check(check, map.view().root));
}

TEST(IorMap, LeafThatTurnsFreeIsForgottenAndReported) {
  IorMap map(coarseConfig());
  map.integrate(wall(1.02f), {}, Pose::Identity());
  const Eigen::Vector3d p(0, 0, 1.02);
  const LeafKey key = *map.keyAt(p);
  for (int i = 0; i < 5; ++i) map.attend(std::vector<LeafKey>{key});
  std::vector<LeafKey> forgotten;
  for (int i = 0; i < 4; ++i) {
    const auto report = map.integrate(wall(2.02f), {}, Pose::Identity());
    forgotten.insert(forgotten.end(), report.forgotten.begin(), report.forgotten.end());
  }
  ASSERT_TRUE(map.findLeaf(p));
  EXPECT_FALSE(map.findLeaf(p)->occupied);
  EXPECT_EQ(map.findLeaf(p)->ior, IorState{});
  EXPECT_EQ(forgotten, std::vector<LeafKey>{key});
}

TEST(IorMap, AttendsOneLeafOfACoarseOccupiedOne) {
  IorMap map(coarseConfig());
  const LeafKey corner{32768, 32768, 32768};
  for (std::uint16_t i = 0; i < 64; ++i) {
    map.tree().setNodeValue(octomap::OcTreeKey(static_cast<std::uint16_t>(corner.x + (i & 3)),
                                               static_cast<std::uint16_t>(corner.y + (i >> 2 & 3)),
                                               static_cast<std::uint16_t>(corner.z + (i >> 4))),
                            3.0f);
  }
  ASSERT_EQ(map.leafCount(), 1u);
  EXPECT_EQ(map.attend(std::vector<LeafKey>{corner}).attended, 1);
  EXPECT_EQ(map.leafCount(), 15u);
  EXPECT_EQ(weight(map.findLeaf(corner)->ior, map.now()), 1u);
  EXPECT_EQ(map.findLeaf(LeafKey{32769, 32768, 32768})->ior, IorState{});
}

TEST(IorMap, HoldsTheSameOccupancyAsOctoMapOnSyntheticViews) {
  IorMap map(coarseConfig());
  testing::OctoMapTwin twin(coarseConfig());
  for (int i = 0; i < 12; ++i) {
    DepthMaps maps = wall(1.5f);
    for (int v = 15; v < 45; ++v) {
      for (int u = 10 + i; u < 40 + i; ++u) maps.depth_m(v, u) = 0.8f + 0.01f * static_cast<float>(u);
    }
    for (int v = 0; v < 60; ++v) maps.depth_m(v, 70) = 0.0f;
    Pose T_WC = poseAt(0.013 + 0.03 * i, 0.007 - 0.02 * i, 0.011 + 0.05 * i);  // off the walls of the leaves
    T_WC.rotate(Eigen::AngleAxisd(0.15 * i, Eigen::Vector3d(0.2, 1.0, 0.3).normalized()));
    map.integrate(maps, {}, T_WC);
    twin.integrate(maps, T_WC);
  }
  const testing::Parity parity = testing::compareWithOctoMap(map, twin.tree(), 20000);
  // Rays through the edge of a leaf, decided by rounding; everything else is the same rule.
  EXPECT_GE(parity.jaccard(), 0.999) << parity.text();
  EXPECT_GE(parity.agreementOverVolume(), 0.999) << parity.text();
  EXPECT_GE(parity.agreement_over_leaves, 0.999) << parity.text();
}

void expectParityOnKitchen(double leaf_size_m, int frames, int reduction) {
  if (!std::filesystem::exists(testing::kitchenDirectory())) {
    GTEST_SKIP() << "no " << testing::kitchenDirectory();
  }
  IorMapConfig config;
  config.leaf_size_m = leaf_size_m;
  IorMap map(config);
  testing::OctoMapTwin twin(config);
  for (int i = 0; i < frames; ++i) {
    const testing::KitchenDepth frame = testing::readKitchenDepth(10 * i, reduction);
    map.integrate(frame.maps, {}, frame.T_WC);
    twin.integrate(frame.maps, frame.T_WC);
  }
  const testing::Parity parity = testing::compareWithOctoMap(map, twin.tree());
  ::testing::Test::RecordProperty("parity", parity.text());
  // The targets are 0.97, 0.98 and 0.005; the rule is OctoMap's own, so the bounds here leave room for rounding only.
  EXPECT_GE(parity.jaccard(), 0.995) << parity.text();
  EXPECT_GE(parity.agreement_over_leaves, 0.995) << parity.text();
  EXPECT_GE(parity.agreementOverVolume(), 0.995) << parity.text();
  EXPECT_LE(parity.contradiction_over_leaves, 0.001) << parity.text();
  EXPECT_LE(parity.contradictionOfOccupied(), 0.005) << parity.text();
}

TEST(IorMap, HoldsTheSameOccupancyAsOctoMapOnKitchenFrames) {
  expectParityOnKitchen(0.04, 4, 2);
}
TEST(SlowIorMap, HoldsTheSameOccupancyAsOctoMapOnFiftyKitchenFramesAtTwoCentimetres) {
  expectParityOnKitchen(0.02, 50, 1);
}
TEST(SlowIorMap, HoldsTheSameOccupancyAsOctoMapOnFiftyKitchenFramesAtOneCentimetre) {
  expectParityOnKitchen(0.01, 50, 1);
}

}  // namespace
}  // namespace saccade
