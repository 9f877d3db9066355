#include "saccade/exchange/occupancy_grid.hpp"

#include <sstream>

#include <gtest/gtest.h>

#include "saccade/map/ior_octree.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

constexpr int kOrigin = MapTree::kCentreKey;

/// A room as the first camera sees it, y down: floor at y = 1 m, a wall at z = 2 m, free before it, in leaves of 5 cm.
IorMap room() {
  IorMapConfig config;
  config.leaf_size_m = 0.05;
  IorMap map(config);
  const auto set = [&](int x, int y, int z, bool occupied) {
    test::setLeaf(map.tree(), kOrigin + x, kOrigin + y, kOrigin + z, occupied);
    if (!occupied) return;
    LeafSurface surface;
    surface.observations = 1;
    surface.setNormal(y == 20 ? Eigen::Vector3f(0, -1, 0) : Eigen::Vector3f(0, 0, -1));
    map.tree().findFinestLeaf(test::octoKey(kOrigin + x, kOrigin + y, kOrigin + z))->setSurface(surface);
  };
  for (int x = -10; x < 10; ++x) {
    for (int z = 0; z <= 40; ++z) set(x, 20, z, true);
    for (int y = -10; y < 20; ++y) {
      set(x, y, 40, true);
      for (int z = 0; z < 40; ++z) set(x, y, z, false);
    }
  }
  map.tree().updateInnerNodes();
  return map;
}

/// Grey value over a point in W.
int cellAt(const OccupancyGrid& grid, const Eigen::Vector3d& p_W) {
  const Eigen::Vector2d p = ((grid.T_GW * p_W).head<2>() - grid.origin_G) / grid.cell_m;
  return grid.cells(grid.cells.rows - 1 - static_cast<int>(p.y()), static_cast<int>(p.x()));
}

OccupancyGridSettings settings() {
  OccupancyGridSettings settings;
  settings.up_W = -Eigen::Vector3d::UnitY();
  return settings;
}

TEST(OccupancyGrid, WallsAreOccupiedTheRoomIsFreeAndTheRestUnknown) {
  const OccupancyGrid grid = makeOccupancyGrid(room(), settings());
  EXPECT_EQ(cellAt(grid, {0.01, 0, 2.02}), OccupancyGrid::kOccupied);
  EXPECT_EQ(cellAt(grid, {0.01, 0, 1.02}), OccupancyGrid::kFree);
  EXPECT_EQ(grid.cells(0, 0), OccupancyGrid::kUnknown);
  EXPECT_EQ(cv::countNonZero(grid.cells == OccupancyGrid::kOccupied), 20);
  EXPECT_EQ(cv::countNonZero(grid.cells == OccupancyGrid::kFree), 800);
}

TEST(OccupancyGrid, TheHeightBandIsCountedFromTheFloor) {
  OccupancyGridSettings low = settings();
  low.lowest_m = -0.1;  // takes the floor in
  low.highest_m = 0.5;
  EXPECT_EQ(cellAt(makeOccupancyGrid(room(), low), {0.01, 0, 1.02}), OccupancyGrid::kOccupied);
  OccupancyGridSettings high = settings();
  high.lowest_m = 3.0;
  high.highest_m = 4.0;
  const OccupancyGrid empty = makeOccupancyGrid(room(), high);
  EXPECT_EQ(cv::countNonZero(empty.cells != OccupancyGrid::kUnknown), 0);
  OccupancyGridSettings none = settings();
  none.highest_m = none.lowest_m;
  EXPECT_THROW((void)makeOccupancyGrid(room(), none), std::invalid_argument);
}

TEST(OccupancyGrid, ATurnedGridHasNoHoles) {
  OccupancyGridSettings turned = settings();
  turned.up_W = Eigen::Vector3d(0.1, -1.0, 0.15).normalized();
  turned.lowest_m = 0.5;
  const OccupancyGrid grid = makeOccupancyGrid(room(), turned);
  for (double z = 0.2; z < 1.5; z += 0.03) {
    for (double x = -0.3; x < 0.3; x += 0.03) EXPECT_EQ(cellAt(grid, {x, 0, z}), OccupancyGrid::kFree);
  }
}

TEST(OccupancyGrid, GoesOutAsMapServerHasIt) {
  const OccupancyGrid grid = makeOccupancyGrid(room(), settings());
  std::ostringstream pgm, yaml;
  writePgm(grid, pgm);
  writeGridYaml(grid, "room.pgm", yaml);
  const std::string header =
      "P5\n" + std::to_string(grid.cells.cols) + " " + std::to_string(grid.cells.rows) + "\n255\n";
  EXPECT_EQ(pgm.str().substr(0, header.size()), header);
  EXPECT_EQ(pgm.str().size(), header.size() + grid.cells.total());
  for (const char* line : {"image: room.pgm\n", "resolution: 0.05\n", "negate: 0\n", "occupied_thresh: 0.65\n"}) {
    EXPECT_NE(yaml.str().find(line), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace saccade
