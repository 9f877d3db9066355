#include "map/depth_windows.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace saccade {
namespace {

constexpr int kLooks = 4000;
// A window reaches at most this many times as far as was asked, and a cell more for the pixel's place in its cell: from
// one size to the next they grow by at most 2.
constexpr float kSlack = 2.0F;

cv::Mat1f randomDepth(int width, int height, double density, std::mt19937& random) {
  cv::Mat1f depth(height, width, 0.0F);
  std::uniform_real_distribution<float> metres(0.3F, 4.0F);
  std::bernoulli_distribution measured(density);
  for (float& z : depth) z = measured(random) ? metres(random) : 0.0F;
  return depth;
}

float largestWithin(const cv::Mat1f& depth, float u, float v, float reach_u, float reach_v) {
  float largest = 0.0F;
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const bool in =
          std::abs(static_cast<float>(column) - u) <= reach_u && std::abs(static_cast<float>(row) - v) <= reach_v;
      if (in) largest = std::max(largest, depth(row, column));
    }
  }
  return largest;
}

// Sparse depths, so that a wrong window meets another largest one.
void expectBounds(int width, int height, double density) {
  std::mt19937 random(7);
  const cv::Mat1f depth = randomDepth(width, height, density, random);
  DepthWindows windows;
  windows.build(depth);
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  std::uniform_real_distribution<float> columns(-0.3F * w, 1.3F * w), rows(-0.3F * h, 1.3F * h), reaches(0.0F, 60.0F);
  constexpr auto kCell = static_cast<float>(DepthWindows::kCellPixels);
  for (int i = 0; i < kLooks; i += kLanes) {
    FloatLanes u, v, reach_u, reach_v;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      u[lane] = columns(random);
      v[lane] = rows(random);
      reach_u[lane] = reaches(random);
      reach_v[lane] = reaches(random);
    }
    const FloatLanes found = farthestAround(windows.table(), u, v, reach_u, reach_v);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      EXPECT_GE(found[lane], largestWithin(depth, u[lane], v[lane], reach_u[lane], reach_v[lane]));
      const float widest = kSlack * (std::max(reach_u[lane], reach_v[lane]) + kCell) + kCell;
      // Outside of the image the window is moved to its edge.
      const float at_u = std::clamp(u[lane], 0.0F, w - 1.0F), at_v = std::clamp(v[lane], 0.0F, h - 1.0F);
      EXPECT_LE(found[lane], largestWithin(depth, at_u, at_v, widest, widest));
    }
  }
}

TEST(DepthWindows, BoundTheDepthsAroundAnyPixelAndLittleMore) {
  expectBounds(160, 120, 0.01);
}

TEST(DepthWindows, BoundThemInImagesThatAreNoMultipleOfTheCellAndSmallerThanAWindow) {
  expectBounds(97, 61, 0.02);
  expectBounds(5, 3, 0.2);
}

TEST(DepthWindows, SeeTheWholeImageFromAnywhereWhereTheReachIsLarge) {
  cv::Mat1f depth(240, 320, 0.0F);
  depth(1, 318) = 3.5F;
  DepthWindows windows;
  windows.build(depth);
  const FloatLanes far =
      farthestAround(windows.table(), allLanes(2.0F), allLanes(238.0F), allLanes(1e6F), allLanes(1.0F));
  const FloatLanes near =
      farthestAround(windows.table(), allLanes(2.0F), allLanes(238.0F), allLanes(8.0F), allLanes(1.0F));
  EXPECT_EQ(far[0], 3.5F);
  EXPECT_EQ(near[0], 0.0F);
}

}  // namespace
}  // namespace saccade
