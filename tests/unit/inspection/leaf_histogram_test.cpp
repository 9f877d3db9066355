#include "saccade/inspection/leaf_histogram.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/ior_trees.hpp"

namespace saccade {
namespace {

using test::setLeaf;

constexpr int kCentre = MapTree::kCentreKey;

/// Leaves along x with the weights 0, 1 ... 9 at tick 10, seen as many times, and a free one.
class LeafHistogramTest : public ::testing::Test {
 protected:
  LeafHistogramTest() : tree_(0.05) {
    for (int x = 0; x < 10; ++x) {
      setLeaf(tree_, kCentre + x, kCentre, kCentre, true);
      IorOcTreeNode* leaf = tree_.findFinestLeaf(test::octoKey(kCentre + x, kCentre, kCentre));
      leaf->setIor(IorState(static_cast<std::uint32_t>(10 + x), false));
      LeafSurface surface;
      surface.observations = static_cast<std::uint16_t>(x);
      leaf->setSurface(surface);
    }
    setLeaf(tree_, kCentre, kCentre + 5, kCentre, false);
    tree_.setNow(Tick{10});
    tree_.updateInnerNodes();
  }

  IorOcTree tree_;
};

TEST_F(LeafHistogramTest, WeightsAreCountedOneATickAndForgottenLeavesApart) {
  const LeafHistogram histogram = histogramOf(tree_.view(), LeafQuantity::kIorWeight, 20);
  EXPECT_EQ(histogram.leaves, 10);
  EXPECT_EQ(histogram.without, 1);
  EXPECT_DOUBLE_EQ(histogram.lowest, 1.0);
  EXPECT_DOUBLE_EQ(histogram.step, 1.0);
  EXPECT_EQ(histogram.counts, std::vector<std::int64_t>(9, 1));
  EXPECT_NEAR(histogram.mean, 5.0, 1e-12);
}

TEST_F(LeafHistogramTest, FewerBinsAreWiderAndLoseNothing) {
  const LeafHistogram histogram = histogramOf(tree_.view(), LeafQuantity::kObservations, 3);
  EXPECT_DOUBLE_EQ(histogram.step, 3.0);
  EXPECT_EQ(histogram.counts, std::vector<std::int64_t>(3, 3));
}

TEST_F(LeafHistogramTest, OccupancyIsBetweenOneHalfAndOne) {
  const LeafHistogram histogram = histogramOf(tree_.view(), LeafQuantity::kOccupancy, 10);
  EXPECT_DOUBLE_EQ(histogram.lowest, 0.5);
  EXPECT_NEAR(histogram.mean, 1.0 / (1.0 + std::exp(-2.0)), 1e-6) << "all leaves have log-odds 2";
  EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::int64_t{0}), 10);
  EXPECT_EQ(histogram.counts[7], 10) << "0.88 lies in 0.85 to 0.90";
}

TEST(LeafHistogram, OfAnEmptyMapIsEmpty) {
  const IorOcTree tree(0.05);
  const LeafHistogram histogram = histogramOf(tree.view(), LeafQuantity::kIorWeight, 5);
  EXPECT_TRUE(histogram.counts.empty());
  EXPECT_EQ(histogram.leaves, 0);
}

TEST(LeafHistogram, WrongNamesAndNoBinsAreRefused) {
  EXPECT_THROW((void)leafQuantity("heat"), std::invalid_argument);
  const IorOcTree tree(0.05);
  EXPECT_THROW((void)histogramOf(tree.view(), LeafQuantity::kIorWeight, 0), std::invalid_argument);
  for (const std::string& name : leafQuantityNames()) EXPECT_NO_THROW((void)leafQuantity(name));
}

}  // namespace
}  // namespace saccade
