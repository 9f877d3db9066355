#include "saccade/map/map_tiles.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade {
namespace {

IorMapConfig smallConfig() {
  IorMapConfig config;
  config.leaf_size_m = 0.05;
  config.ior.ior_limit = 2;
  return config;
}

/// A map with occupied, free and coarse leaves and some memory.
IorMap exploredMap() {
  IorMap map(smallConfig());
  DepthMaps maps;
  maps.camera = {80, 60, 80.0, 80.0, 39.5, 29.5};
  maps.depth_m = cv::Mat1f(60, 80, 2.02f);
  const cv::Mat3b color(60, 80, cv::Vec3b(1, 2, 3));
  for (int i = 0; i < 8; ++i) {
    Pose T_WC = Pose::Identity();
    T_WC.translation() = Eigen::Vector3d(0.01 * i, 0.02, 0.03);
    map.integrate(maps, color, T_WC);
    std::vector<LeafKey> keys;
    map.forEachLeaf([&](const MapLeaf& leaf) {
      if (leaf.occupied && leaf.key.corner.x % 3 != 0) keys.push_back(leaf.key.corner);
    });
    map.attend(keys);
  }
  return map;
}

const std::filesystem::path kSource = "map.saccade";

TEST(MapTiles, RestoreTheMapTheyWereMadeFromAtAnyTileDepth) {
  const IorMap map = exploredMap();
  for (const int depth : {0, 3, 10, 13, 16}) {
    const std::vector<MapTile> tiles = encodeTiles(map, depth);
    const IorMap again = restoreMap(smallConfig(), tiles, map.now(), kSource);
    EXPECT_TRUE(again.tree() == map.tree()) << depth;
    EXPECT_EQ(again.now(), map.now());
    EXPECT_EQ(again.nodeCount(), map.nodeCount());
    const std::vector<MapTile> twice = encodeTiles(again, depth);
    ASSERT_EQ(twice.size(), tiles.size());
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      ASSERT_EQ(twice[i].root, tiles[i].root);
      ASSERT_EQ(twice[i].data, tiles[i].data);
    }
  }
}

TEST(MapTiles, CoarseLeavesAboveTheTileDepthAreTilesOfTheirOwn) {
  const IorMap map = exploredMap();
  bool coarse = false;
  for (const NodeKey& root : listTiles(map, 16)) coarse |= root.depth < 16;
  EXPECT_TRUE(coarse);
  EXPECT_TRUE(listTiles(IorMap(smallConfig())).empty());
}

TEST(MapTiles, ChangesNameEveryTileThatDiffers) {
  constexpr int kDepth = 13;  // many small tiles
  IorMap map(smallConfig());
  std::map<NodeKey, std::vector<std::byte>> before;
  DepthMaps maps;
  maps.camera = {80, 60, 80.0, 80.0, 39.5, 29.5};
  std::size_t unchanged = 0;
  for (int i = 0; i < 40; ++i) {
    maps.depth_m = cv::Mat1f(60, 80, 1.5f + 0.1f * static_cast<float>(i % 7));
    const Pose T_WC(Eigen::Translation3d(0.02 * i, 0.0, 0.0) *
                    Eigen::AngleAxisd(0.4 * static_cast<double>(i % 5), Eigen::Vector3d::UnitY()));
    if (i % 3 != 2) map.integrate(maps, {}, T_WC);
    std::vector<LeafKey> keys;
    map.forEachLeaf([&](const MapLeaf& leaf) {
      if (leaf.occupied && leaf.key.corner.x % 32 == i % 32) keys.push_back(leaf.key.corner);
    });
    map.attend(keys);

    std::map<NodeKey, std::vector<std::byte>> after;
    for (const TileChange& tile : takeTileChanges(map, kDepth)) {
      appendTile(tile.node, after[tile.root]);
      ASSERT_EQ(after[tile.root], encodeTile(map, tile.root));
      const auto old = before.find(tile.root);
      const bool differs = old == before.end() || old->second != after[tile.root];
      EXPECT_TRUE(tile.changed || !differs) << "step " << i;
      unchanged += tile.changed ? 0 : 1;
    }
    EXPECT_EQ(after.size(), listTiles(map, kDepth).size());
    before = std::move(after);
  }
  EXPECT_GT(unchanged, 100U);  // and not simply all of them
}

TEST(MapTiles, AttendingOneLeafChangesOneTile) {
  IorMap map = exploredMap();
  std::vector<LeafKey> key;
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (leaf.occupied && leaf.key.depth == MapTree::kDepth && key.empty()) key.push_back(leaf.key.corner);
  });
  ASSERT_EQ(key.size(), 1U);
  (void)takeTileChanges(map);
  map.attend(key);
  int changed = 0;
  for (const TileChange& tile : takeTileChanges(map)) changed += tile.changed && !tile.node.isLeaf() ? 1 : 0;
  EXPECT_EQ(changed, 1);
}

TEST(MapTiles, ATileThatWasTakenOutComesBackAsItWasAndCountsAsUnchanged) {
  for (const int depth : {3, 8, 10, 12}) {
    IorMap map = exploredMap();
    const IorMap original = exploredMap();
    (void)takeTileChanges(map, depth);
    int inner = 0;
    for (const TileChange& tile : tileChanges(original, depth)) {
      if (tile.node.isLeaf()) {
        EXPECT_THROW(removeTile(map, tile.root), std::invalid_argument);
        continue;
      }
      ++inner;
      const MapTile away{tile.root, encodeTile(map, tile.root)};
      const std::size_t used = map.usedBytes();
      removeTile(map, tile.root);
      EXPECT_LT(map.usedBytes(), used);
      EXPECT_THROW((void)encodeTile(map, tile.root), std::invalid_argument);
      EXPECT_THROW(removeTile(map, tile.root), std::invalid_argument);
      insertTile(map, away, kSource);
      EXPECT_EQ(map.usedBytes(), used);
      EXPECT_THROW(insertTile(map, away, kSource), IoError);
    }
    EXPECT_GT(inner, 0) << depth;
    EXPECT_TRUE(map.tree() == original.tree()) << depth;
    for (const TileChange& tile : tileChanges(map, depth)) EXPECT_EQ(tile.changed, tile.node.isLeaf());
  }
}

TEST(MapTiles, WithoutItsTilesAMapHoldsWhatIsNoTileAndGetsThemBackInAnyOrder) {
  IorMap map = exploredMap();
  const IorMap original = exploredMap();
  std::vector<MapTile> away;
  std::size_t leaves = 0;
  for (const TileChange& tile : tileChanges(original)) {
    if (tile.node.isLeaf()) {
      ++leaves;
      continue;
    }
    away.push_back({tile.root, encodeTile(map, tile.root)});
    removeTile(map, tile.root);
  }
  ASSERT_GT(away.size(), 1U);
  EXPECT_EQ(map.leafCount(), leaves);
  std::shuffle(away.begin(), away.end(), std::mt19937(3));
  for (const MapTile& tile : away) insertTile(map, tile, kSource);
  EXPECT_TRUE(map.tree() == original.tree());
  EXPECT_EQ(map.nodeCount(), original.nodeCount());
}

TEST(MapTiles, RestoredMapGoesOnExactlyAsTheOriginal) {
  IorMap map = exploredMap();
  IorMap again = restoreMap(smallConfig(), encodeTiles(map), map.now(), kSource);
  DepthMaps maps;
  maps.camera = {80, 60, 80.0, 80.0, 39.5, 29.5};
  maps.depth_m = cv::Mat1f(60, 80, 2.52f);
  for (int i = 0; i < 5; ++i) {
    for (IorMap* m : {&map, &again}) {
      m->integrate(maps, {}, Pose::Identity());
      std::vector<LeafKey> keys;
      m->forEachLeaf([&](const MapLeaf& leaf) {
        if (leaf.occupied && leaf.key.corner.y % 2 == 0) keys.push_back(leaf.key.corner);
      });
      m->attend(keys);
    }
  }
  EXPECT_TRUE(map.tree() == again.tree());
  EXPECT_EQ(encodeTiles(map).size(), encodeTiles(again).size());
}

TEST(MapTiles, RefuseEveryTruncationAndEveryByteTooMany) {
  const IorMap map = exploredMap();
  const std::vector<MapTile> tiles = encodeTiles(map, 13);
  const MapTile* largest = &tiles.front();
  for (const MapTile& tile : tiles) largest = tile.data.size() > largest->data.size() ? &tile : largest;
  for (std::size_t n = 0; n < largest->data.size(); n += n < 64 ? 1 : 7) {
    MapTile cut = *largest;
    cut.data.resize(n);
    ASSERT_THROW((void)restoreMap(smallConfig(), {&cut, 1}, {}, kSource), IoError) << n;
  }
  MapTile longer = *largest;
  longer.data.push_back(std::byte{0});
  EXPECT_THROW((void)restoreMap(smallConfig(), {&longer, 1}, {}, kSource), IoError);
}

TEST(MapTiles, DamagedBytesAreRefusedOrGiveASoundMap) {
  const IorMap map = exploredMap();
  const std::vector<MapTile> tiles = encodeTiles(map, 12);
  std::mt19937 random(2);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    MapTile tile = tiles[random() % tiles.size()];
    for (int i = 0; i < 3; ++i) tile.data[random() % tile.data.size()] = static_cast<std::byte>(random());
    try {
      const IorMap restored = restoreMap(smallConfig(), {&tile, 1}, {}, kSource);
      ASSERT_EQ(restored.nodeCount(), restored.tree().calcNumNodes());
    } catch (const IoError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(MapTiles, RefuseForeignVersionsPlacesOverlapsAndEndlessDepth) {
  const IorMap map = exploredMap();
  std::vector<MapTile> tiles = encodeTiles(map);
  std::vector<MapTile> doubled{tiles[0], tiles[0]};
  EXPECT_THROW((void)restoreMap(smallConfig(), doubled, {}, kSource), IoError);
  MapTile tile = tiles[0];
  tile.data[0] = std::byte{2};
  EXPECT_THROW((void)restoreMap(smallConfig(), {&tile, 1}, {}, kSource), IoError);
  tile = tiles[0];
  tile.root.corner.x = static_cast<std::uint16_t>(tile.root.corner.x + 1);
  EXPECT_THROW((void)restoreMap(smallConfig(), {&tile, 1}, {}, kSource), IoError);
  tile.root = {{}, 17};
  EXPECT_THROW((void)restoreMap(smallConfig(), {&tile, 1}, {}, kSource), IoError);
  tile.root = {{}, 0};
  tile.data = {std::byte{1}, std::byte{2}};
  for (int i = 0; i < 100; ++i) tile.data.insert(tile.data.end(), {std::byte{1}, std::byte{1}, std::byte{0}});
  EXPECT_THROW((void)restoreMap(smallConfig(), {&tile, 1}, {}, kSource), IoError);
  EXPECT_THROW((void)encodeTile(map, NodeKey{{}, 16}), std::invalid_argument);
  EXPECT_THROW((void)listTiles(map, 17), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
