#include "saccade/evaluation/trajectory_error.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

constexpr double kRounding = 1e-9;

/// A camera that walks along a bend and turns.
std::vector<StampedPose> walk(int count) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < count; ++i) {
    const double t = i / 30.0;
    poses.push_back({t, test::poseOf({0.3, 1.0, 0.1}, 10.0 * t, {0.5 * t, 0.1 * std::sin(3.0 * t), 0.2 * t * t})});
  }
  return poses;
}

std::vector<StampedPose> moved(std::vector<StampedPose> poses, const Pose& T) {
  for (StampedPose& pose : poses) pose.T_WC = T * pose.T_WC;
  return poses;
}

TEST(Associate, TakesTheNearestWithinTheGapAndLeavesTheRestOut) {
  const std::vector<StampedPose> estimate = {{0.000, {}}, {0.033, {}}, {0.066, {}}};
  const std::vector<StampedPose> truth = {{0.004, {}}, {0.048, {}}, {0.060, {}}, {1.0, {}}};
  const auto pairs = associate(estimate, truth, 0.010);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].estimate.stamp_s, 0.000);
  EXPECT_EQ(pairs[1].estimate.stamp_s, 0.066);
  EXPECT_TRUE(associate({}, truth).empty());
}

TEST(AbsoluteError, IsZeroForATrajectoryThatWasOnlyMoved) {
  const auto truth = walk(60);
  const auto estimate = moved(truth, test::poseOf({1, 2, 3}, 70.0, {5, -4, 2}));
  const AbsoluteError error = absoluteError(associate(estimate, truth));
  EXPECT_EQ(error.matched, 60);
  EXPECT_NEAR(error.rmse_m, 0.0, kRounding);
  EXPECT_NEAR(error.max_m, 0.0, kRounding);
}

TEST(AbsoluteError, OfAnErrorThatAlignmentCannotTakeAwayIsItsSize) {
  // Up and down by 1 cm at the corners of a square: the mean is 0 and no turn helps.
  std::vector<StampedPose> truth, estimate;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner(i == 1 || i == 2 ? 1.0 : 0.0, i >= 2 ? 1.0 : 0.0, 0.0);
    truth.push_back({i * 0.1, test::poseOf({0, 0, 1}, 0.0, corner)});
    estimate.push_back({i * 0.1, test::poseOf({0, 0, 1}, 0.0, corner + Eigen::Vector3d(0, 0, i % 2 ? 0.01 : -0.01))});
  }
  const AbsoluteError error = absoluteError(associate(estimate, truth));
  EXPECT_NEAR(error.rmse_m, 0.01, 1e-6);
  EXPECT_NEAR(error.mean_m, 0.01, 1e-6);
  EXPECT_NEAR(error.median_m, 0.01, 1e-6);
  EXPECT_NEAR(error.max_m, 0.01, 1e-6);
}

TEST(AbsoluteError, DoesNotMirror) {
  // A left-handed copy of a trajectory must not align with it.
  const auto truth = walk(60);
  std::vector<StampedPose> mirrored = truth;
  for (StampedPose& pose : mirrored) pose.T_WC.translation().y() *= -1.0;
  EXPECT_GT(absoluteError(associate(mirrored, truth)).rmse_m, 0.005);
}

TEST(RelativeError, IsTheDriftASecondWhateverTheStart) {
  const auto truth = walk(90);
  std::vector<StampedPose> estimate = moved(truth, test::poseOf({0, 1, 0}, 30.0, {1, 1, 1}));
  EXPECT_NEAR(relativeError(associate(estimate, truth)).translation_rmse_m, 0.0, kRounding);

  // A camera that stands still but whose estimate slides 2 cm and turns 0.01 rad a second.
  std::vector<StampedPose> still, sliding;
  for (int i = 0; i < 90; ++i) {
    const double t = i / 30.0;
    still.push_back({t, Pose::Identity()});
    sliding.push_back({t, test::poseOf({0, 0, 1}, 0.01 * t * 180.0 / 3.14159265358979, {0, 0, 0.02 * t})});
  }
  const RelativeError error = relativeError(associate(sliding, still));
  EXPECT_EQ(error.pairs, 60);
  EXPECT_NEAR(error.translation_rmse_m, 0.02, 1e-9);
  EXPECT_NEAR(error.rotation_rmse_rad, 0.01, 1e-9);
}

TEST(TrajectoryError, OfNothingIsZeroAndMatchesNothing) {
  EXPECT_EQ(absoluteError({}).matched, 0);
  EXPECT_EQ(absoluteError({}).rmse_m, 0.0);
  EXPECT_EQ(relativeError({}).pairs, 0);
}

}  // namespace
}  // namespace saccade
