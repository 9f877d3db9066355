#include "saccade/evaluation/local_alignment.hpp"

#include <cmath>
#include <functional>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

constexpr double kRounding = 1e-9;

/// A walk of 12 m, a frame each 10 cm.
std::vector<PosePair> walk(const std::function<Pose(const Pose&)>& estimate) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 120; ++i) {
    const Pose truth = test::poseOf({0.2, 1.0, 0.1}, 3.0 * i, {0.1 * i, 0.2 * std::sin(0.1 * i), 0.0});
    pairs.push_back({{i / 30.0, estimate(truth)}, {i / 30.0, truth}});
  }
  return pairs;
}

Pose between(const std::vector<PosePair>& pairs, std::size_t frame) {
  return pairs[frame].truth.T_WC * test::poseOf({1.0, 0.3, 0.0}, 4.0, {0.02, 0.05, 0.01});
}

TEST(LocalAlignment, IsTheOneRigidMotionWhereThereIsOnlyOne) {
  const Pose T = test::poseOf({1, 2, 3}, 70.0, {5, -4, 2});
  const auto pairs = walk([&](const Pose& truth) { return T * truth; });
  const LocalAlignment alignment(pairs);
  for (const std::size_t frame : {0U, 40U, 119U}) {
    const Pose truth = between(pairs, frame);
    EXPECT_TRUE(alignment.toEstimate(truth).isApprox(T * truth, kRounding));
  }
}

TEST(LocalAlignment, LeavesDriftOutThatOneMotionForAllKeeps) {
  // 2 % too long, 24 cm over the walk, and bent aside by 14 cm; 4.4 % of the way where that is worst.
  const auto drifted = [](const Pose& truth) {
    const double x = truth.translation().x();
    return Pose(test::poseOf({0, 0, 1}, 0.0, {0.02 * x, 0.001 * x * x, 0.0}) * truth);
  };
  const auto pairs = walk(drifted);
  const LocalAlignment local(pairs);
  const Pose T_truth_estimate = alignToTruth(pairs);
  double largest_local_m = 0.0, largest_global_m = 0.0;
  for (std::size_t frame = 0; frame < pairs.size(); frame += 7) {
    const Pose truth = between(pairs, frame), expected = drifted(truth);
    const auto errorOf = [&](const Pose& pose) { return (pose.translation() - expected.translation()).norm(); };
    largest_local_m = std::max(largest_local_m, errorOf(local.toEstimate(truth)));
    largest_global_m = std::max(largest_global_m, errorOf(T_truth_estimate.inverse() * truth));
  }
  EXPECT_LT(largest_local_m, 0.044 * 0.25) << "the way to the middle of the nearest frames, at the walk's end";
  EXPECT_GT(largest_global_m, 0.05);
}

TEST(LocalAlignment, DoesNotHideThatAPlaceIsWrong) {
  const auto pairs = walk([](const Pose& truth) { return truth; });
  const LocalAlignment alignment(pairs);
  const Pose truth = between(pairs, 60);
  const Pose wrong = test::poseOf({0, 0, 1}, 0.0, {0.06, 0.0, 0.0}) * truth;
  EXPECT_NEAR((alignment.toEstimate(truth).translation() - wrong.translation()).norm(), 0.06, kRounding);
}

TEST(LocalAlignment, TakesOneFrameWhereThereIsButOneAndRefusesNone) {
  auto pairs = walk([](const Pose& truth) { return truth; });
  pairs.resize(1);
  const Pose truth = between(pairs, 0);
  EXPECT_TRUE(LocalAlignment(pairs).toEstimate(truth).isApprox(truth, kRounding));
  EXPECT_THROW(LocalAlignment({}), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
