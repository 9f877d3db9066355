#include "saccade/rendering/back_project.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/rendering/renderer.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

const PinholeCamera kCamera{80, 60, 70.0, 70.0, 39.5, 29.5};

class BackProject : public testing::Test {
 protected:
  void SetUp() override {
    test::fillRandomly(tree_, random_, 12, 1500);
    view_ = cloneView(renderer_.renderIor(
        tree_.view(), kCamera, test::lookAlong({-1.6, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ())));
    ASSERT_GT(view_.leaves.size(), 100u);
  }
  /// Brute force: the keys at the mask's pixels.
  std::vector<LeafKey> expected(const cv::Mat1b& mask) const {
    std::set<LeafKey> keys;
    for (int v = 0; v < mask.rows; ++v) {
      for (int u = 0; u < mask.cols; ++u) {
        const auto key = view_.keyAt(u, v);
        if (mask(v, u) != 0 && key) keys.insert(*key);
      }
    }
    std::vector<LeafKey> ordered(keys.begin(), keys.end());
    std::sort(ordered.begin(), ordered.end(), comesBefore);
    return ordered;
  }
  static bool comesBefore(const LeafKey& a, const LeafKey& b) { return mortonCode(a) < mortonCode(b); }
  static std::vector<LeafKey> keysOf(const BackProjector& projector) {
    std::vector<LeafKey> keys;
    projector.keys(keys);
    return keys;
  }

  std::mt19937 random_{5};
  IorOcTree tree_{0.05};
  Renderer renderer_;
  IorView view_;
};

TEST_F(BackProject, GivesEachLeafOfTheUnionOfTheMasksOnce) {
  cv::Mat1b left(60, 80, std::uint8_t{0}), right = left.clone();
  left(cv::Rect(5, 5, 40, 40)) = 255;
  right(cv::Rect(30, 20, 45, 30)) = 1;
  const std::vector<cv::Mat1b> masks = {left, right};
  const auto keys = backProject(masks, view_);
  EXPECT_EQ(keys, expected(cv::Mat1b(cv::Mat(left | right))));
  EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end(), comesBefore));
  EXPECT_GT(keys.size(), 50u);
}

TEST_F(BackProject, GivesTheSameForMasksRunsAndSegments) {
  cv::Mat1i labels(60, 80);
  for (int& label : labels) label = static_cast<int>(random_() % 5) - 1;
  const std::vector<std::uint8_t> chosen = {1, 0, 1};
  cv::Mat1b mask(60, 80, std::uint8_t{0});
  BackProjector by_runs;
  by_runs.begin(view_);
  for (int v = 10; v < 50; ++v) {
    for (int u = 20; u < 70; ++u) {
      if (labels(v, u) != 0 && labels(v, u) != 2) continue;
      mask(v, u) = 255;
      by_runs.addRun(v, u, u + 1);
    }
  }
  BackProjector by_segments;
  by_segments.begin(view_);
  by_segments.addSegments(labels, chosen, {20, 10, 50, 40});
  EXPECT_EQ(keysOf(by_runs), expected(mask));
  EXPECT_EQ(keysOf(by_segments), expected(mask));
}

TEST_F(BackProject, TellsTheLeavesOfEachMaskFromThoseOfAll) {
  cv::Mat1b left(60, 80, std::uint8_t{0}), right = left.clone();
  left(cv::Rect(5, 5, 40, 40)) = 255;
  right(cv::Rect(30, 20, 45, 30)) = 1;
  BackProjector projector;
  projector.begin(view_);
  projector.addMask(left);
  EXPECT_EQ(keysOf(projector), expected(left));
  projector.beginMask();
  EXPECT_TRUE(keysOf(projector).empty());
  projector.addMask(right);
  EXPECT_EQ(keysOf(projector), expected(right));
  std::vector<LeafKey> all;
  projector.allKeys(all);
  EXPECT_EQ(all, expected(cv::Mat1b(cv::Mat(left | right))));
}

TEST_F(BackProject, ForgetsWhatBelongedToTheViewBefore) {
  BackProjector projector;
  projector.begin(view_);
  projector.addMask(cv::Mat1b(60, 80, std::uint8_t{1}));
  EXPECT_EQ(keysOf(projector).size(), view_.leaves.size());
  projector.begin(view_);
  EXPECT_TRUE(keysOf(projector).empty());
}

TEST_F(BackProject, RefusesWhatDoesNotFitTheView) {
  BackProjector projector;
  EXPECT_THROW(projector.addMask(cv::Mat1b(60, 80)), std::invalid_argument);
  projector.begin(view_);
  EXPECT_THROW(projector.addMask(cv::Mat1b(80, 60)), std::invalid_argument);
  EXPECT_THROW(projector.addMask(cv::Mat1b()), std::invalid_argument);
  EXPECT_THROW(projector.addRun(0, 0, 81), std::invalid_argument);
  EXPECT_THROW(projector.addRun(60, 0, 1), std::invalid_argument);
  EXPECT_THROW(projector.addRun(-1, 0, 1), std::invalid_argument);
  EXPECT_THROW(projector.addRun(5, 4, 3), std::invalid_argument);
  EXPECT_THROW(projector.addSegments(cv::Mat1i(60, 80, 0), {}, {70, 0, 11, 1}), std::invalid_argument);
  EXPECT_NO_THROW(projector.addRun(59, 80, 80));
}

}  // namespace
}  // namespace saccade
