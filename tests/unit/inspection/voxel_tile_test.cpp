#include "saccade/inspection/voxel_tile.hpp"

#include <array>
#include <cstring>
#include <map>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/map/ior_map.hpp"
#include "saccade/map/ior_octree.hpp"
#include "saccade/map/map_tiles.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

struct Voxel {
  std::array<std::uint8_t, 3> cell;
  std::uint8_t log2_edge;
  std::array<std::uint8_t, 3> rgb;
  std::uint8_t occupancy;
  std::array<std::int8_t, 3> normal;
  std::uint8_t open_faces;
};

struct Tile {
  std::array<std::uint16_t, 3> corner{};
  int root_depth = 0, voxel_depth = 0;
  std::vector<Voxel> voxels;
  std::vector<std::uint32_t> ior;
};

Tile decode(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 4), "SVT1");
  Tile tile;
  std::memcpy(tile.corner.data(), bytes.data() + 4, 6);
  tile.root_depth = bytes[10];
  tile.voxel_depth = bytes[11];
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 12, 4);
  EXPECT_EQ(bytes.size(), 16 + 16 * static_cast<std::size_t>(count));
  tile.voxels.resize(count);
  tile.ior.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) std::memcpy(&tile.voxels[i], bytes.data() + 16 + 12 * i, 12);
  for (std::uint32_t i = 0; i < count; ++i) std::memcpy(&tile.ior[i], bytes.data() + 16 + 12 * count + 4 * i, 4);
  return tile;
}

constexpr int kCorner = MapTree::kCentreKey;
const NodeKey kRoot{{kCorner, kCorner, kCorner}, kTileDepth};

/// Occupied leaves around the world's origin at random, in all eight tiles that meet there.
IorMap randomMap() {
  IorMap map;
  std::mt19937 random(3);
  test::fillRandomly(map.tree(), random, 20, 3000);
  map.setNow(Tick{50});
  return map;
}

TEST(VoxelTile, AtTheFinestDepthHoldsEveryOccupiedLeafWithItsMemory) {
  const IorMap map = randomMap();
  std::size_t voxels = 0, leaves = 0;
  for (const NodeKey& root : listTiles(map)) {
    const Tile tile = decode(encodeVoxels(map.view(), root, kFinestVoxelDepth));
    voxels += tile.voxels.size();
    for (std::size_t i = 0; i < tile.voxels.size(); ++i) {
      const Voxel& v = tile.voxels[i];
      const LeafKey key{static_cast<std::uint16_t>(tile.corner[0] + v.cell[0]),
                        static_cast<std::uint16_t>(tile.corner[1] + v.cell[1]),
                        static_cast<std::uint16_t>(tile.corner[2] + v.cell[2])};
      const auto leaf = map.findLeaf(key);
      ASSERT_TRUE(leaf && leaf->occupied);
      EXPECT_EQ(leaf->key.depth, MapTree::kDepth - v.log2_edge);
      EXPECT_EQ(leaf->surface.red, v.rgb[0]);
      EXPECT_EQ(weight(leaf->ior, map.now()), weight(IorState::fromBits(tile.ior[i]), map.now()));
      EXPECT_EQ(inhibited(leaf->ior, map.now()), inhibited(IorState::fromBits(tile.ior[i]), map.now()));
    }
  }
  map.forEachLeaf([&](const MapLeaf& leaf) { leaves += leaf.occupied ? 1 : 0; });
  EXPECT_EQ(voxels, leaves);
  EXPECT_GT(voxels, 1000u);
}

TEST(VoxelTile, AtACoarserDepthIsOccupiedAndInhibitedWhereAnyLeafIs) {
  const IorMap map = randomMap();
  constexpr int kDepth = 14, kShift = MapTree::kDepth - kDepth;
  std::map<LeafKey, bool> expected, found;  // inhibited, by the voxel's corner
  const auto cornerOf = [](const LeafKey& key) {
    const auto low = [](std::uint16_t part) { return static_cast<std::uint16_t>(part >> kShift << kShift); };
    return LeafKey{low(key.x), low(key.y), low(key.z)};
  };
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (leaf.occupied) expected[cornerOf(leaf.key.corner)] |= inhibited(leaf.ior, map.now());
  });
  for (const NodeKey& root : listTiles(map)) {
    const Tile tile = decode(encodeVoxels(map.view(), root, kDepth));
    for (std::size_t i = 0; i < tile.voxels.size(); ++i) {
      const auto& cell = tile.voxels[i].cell;
      const LeafKey key{static_cast<std::uint16_t>(tile.corner[0] + (cell[0] << kShift)),
                        static_cast<std::uint16_t>(tile.corner[1] + (cell[1] << kShift)),
                        static_cast<std::uint16_t>(tile.corner[2] + (cell[2] << kShift))};
      found[key] = inhibited(IorState::fromBits(tile.ior[i]), map.now());
    }
  }
  EXPECT_EQ(found, expected);
}

TEST(VoxelTile, OpensTheFacesWithoutANeighbour) {
  IorMap map;
  for (int i = 0; i < 2; ++i) test::setLeaf(map.tree(), kCorner + 10 + i, kCorner + 10, kCorner + 10, true);
  map.tree().updateInnerNodes();
  const Tile tile = decode(encodeVoxels(map.view(), kRoot, kFinestVoxelDepth));
  ASSERT_EQ(tile.voxels.size(), 2u);
  EXPECT_EQ(tile.voxels[0].open_faces, 0x3F & ~0x02);  // the other is at +x
  EXPECT_EQ(tile.voxels[1].open_faces, 0x3F & ~0x01);
}

TEST(VoxelTile, ThatTheMapDoesNotHaveIsEmpty) {
  EXPECT_TRUE(decode(encodeVoxels(IorMap().view(), kRoot, kFinestVoxelDepth)).voxels.empty());
}

TEST(VoxelTile, RefusesDepthsAndRootsThatItsBytesCannotHold) {
  const IorMap map = randomMap();
  EXPECT_THROW((void)encodeVoxels(map.view(), kRoot, 9), std::invalid_argument);
  EXPECT_THROW((void)encodeVoxels(map.view(), kRoot, 17), std::invalid_argument);
  EXPECT_THROW((void)encodeVoxels(map.view(), {{}, 0}, kFinestVoxelDepth), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
