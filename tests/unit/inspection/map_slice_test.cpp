#include "saccade/inspection/map_slice.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/ior_trees.hpp"

namespace saccade {
namespace {

using test::setLeaf;

constexpr int kCentre = MapTree::kCentreKey;
constexpr double kLeafSize_m = 0.05;

/// In the layer x = 0: three leaves along y of which one is inhibited and one only remembered, a coarse free block of
/// 4³ behind them.
class MapSliceTest : public ::testing::Test {
 protected:
  MapSliceTest() : tree_(kLeafSize_m) {
    for (int y = 0; y < 3; ++y) setLeaf(tree_, kCentre, kCentre + y, kCentre, true);
    remember(0, IorState(50, true));
    remember(1, IorState(50, false));
    for (int i = 0; i < 64; ++i) {
      setLeaf(tree_, kCentre + (i & 3), kCentre + (i >> 2 & 3), kCentre + 4 + (i >> 4), false);
    }
    tree_.setNow(Tick{10});
    tree_.updateInnerNodes();
  }

  void remember(int y, IorState ior) {
    tree_.findFinestLeaf(test::octoKey(kCentre, kCentre + y, kCentre))->setIor(ior);
  }

  IorOcTree tree_;
};

TEST_F(MapSliceTest, CountsTheLeavesThatThePlaneCutsCoarseOnesCellByCell) {
  const MapSlice slice = sliceMap(tree_.view(), {0, 0.01});
  EXPECT_EQ(slice.cells.size(), cv::Size(8, 4)) << "z runs along the columns, y along the rows";
  const auto counts = slice.counts();
  EXPECT_EQ(counts[static_cast<std::size_t>(CellState::kInhibited)], 1);
  EXPECT_EQ(counts[static_cast<std::size_t>(CellState::kAttended)], 1);
  EXPECT_EQ(counts[static_cast<std::size_t>(CellState::kOccupied)], 1);
  EXPECT_EQ(counts[static_cast<std::size_t>(CellState::kFree)], 16);
  EXPECT_EQ(counts[static_cast<std::size_t>(CellState::kUnknown)], 32 - 19);
  EXPECT_EQ(slice.cells(0, 0), static_cast<std::uint8_t>(CellState::kInhibited));
  EXPECT_EQ(slice.cells(3, 4), static_cast<std::uint8_t>(CellState::kFree));
  EXPECT_DOUBLE_EQ(slice.cell_m, kLeafSize_m);
}

TEST_F(MapSliceTest, APlaneJustBesideSeesTheNextLayer) {
  const MapSlice slice = sliceMap(tree_.view(), {0, -0.01});
  EXPECT_TRUE(slice.cells.empty()) << "nothing is known at x < 0";
  EXPECT_EQ(sliceMap(tree_.view(), {0, kLeafSize_m + 0.01}).cells.size(), cv::Size(4, 4));
}

TEST_F(MapSliceTest, APlanHasWhatLiesAheadAtTheTop) {
  const MapSlice slice = sliceMap(tree_.view(), {1, 0.01});
  ASSERT_EQ(slice.cells.size(), cv::Size(4, 8));
  EXPECT_EQ(slice.cells(7, 0), static_cast<std::uint8_t>(CellState::kInhibited));
  EXPECT_EQ(slice.cells(0, 3), static_cast<std::uint8_t>(CellState::kFree));
  EXPECT_DOUBLE_EQ(slice.first_row_m, 8 * kLeafSize_m);
  EXPECT_DOUBLE_EQ(slice.row_step_m, -kLeafSize_m);
}

TEST_F(MapSliceTest, AWideSliceJoinsLeavesAndKeepsWhatMattersMost) {
  setLeaf(tree_, kCentre, kCentre, kCentre + 2 * MapSlice::kMostCells, true);
  tree_.updateInnerNodes();
  const MapSlice slice = sliceMap(tree_.view(), {0, 0.01});
  EXPECT_LE(slice.cells.cols, MapSlice::kMostCells);
  EXPECT_DOUBLE_EQ(slice.cell_m, 4 * kLeafSize_m);
  EXPECT_EQ(slice.cells(0, 0), static_cast<std::uint8_t>(CellState::kInhibited));
}

TEST_F(MapSliceTest, ACoordinateThatNoLeafCanHaveIsRefused) {
  for (const double wrong : {1e9, -1e9, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW((void)sliceMap(tree_.view(), {2, wrong}), std::invalid_argument) << wrong;
  }
}

TEST_F(MapSliceTest, InhibitedCellsArePaintedWhiteAndAnEmptySliceIsStillAPicture) {
  const cv::Mat3b picture = paintSlice(sliceMap(tree_.view(), {0, 0.01}));
  EXPECT_EQ(picture(0, 0), cv::Vec3b(255, 255, 255));
  EXPECT_NE(picture(picture.rows - 1, 0), cv::Vec3b(255, 255, 255));
  EXPECT_FALSE(paintSlice(sliceMap(tree_.view(), {0, -5.0})).empty());
}

TEST(ShrinkCells, KeepsTheLastStateOfThoseItJoins) {
  const cv::Mat1b cells = (cv::Mat1b(2, 4) << 0, 1, 1, 2, 0, 0, 4, 1);
  const cv::Mat1b small = shrinkCells(cells, 2, 1);
  ASSERT_EQ(small.size(), cv::Size(2, 1));
  EXPECT_EQ(small(0, 0), 1);
  EXPECT_EQ(small(0, 1), 4);
}

}  // namespace
}  // namespace saccade
