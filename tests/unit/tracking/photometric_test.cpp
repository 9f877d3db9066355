#include "tracking/photometric.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "saccade/tracking/tracker.hpp"
#include "support/painted_scene.hpp"
#include "tracking/rigid_motion.hpp"

namespace saccade {
namespace {

using test::cornerWithBalls;
using test::DepthScene;
using test::paintedIntensity;
using test::poseOf;

// Images are of 320x240 pixels, so half of them shows the paint's waves over some ten pixels each.
PinholeCamera camera() {
  return {320, 240, 292.5, 292.5, 159.5, 119.5};
}

DepthScene wall() {
  DepthScene scene;
  scene.planes = {{Eigen::Vector3d(0.1, 0.2, -1.0).normalized(), -1.4}};
  return scene;
}

DepthMaps measured(const DepthScene& scene, const Pose& T_WC) {
  DepthMaps maps;
  DepthPreparation().prepare(scene.render(camera(), T_WC), camera(), maps);
  return maps;
}

ModelView exactView(const DepthScene& scene) {
  ModelView view;
  view.camera = camera().reducedBy(2);
  view.depth_m = scene.render(view.camera, Pose::Identity());
  view.normals = cv::Mat3f(view.depth_m.size(), cv::Vec3f(0, 0, 0));
  for (int v = 0; v < view.depth_m.rows; ++v) {
    for (int u = 0; u < view.depth_m.cols; ++u) {
      const Eigen::Vector3f n = scene.meetPixel(view.camera, Pose::Identity(), u, v).normal.cast<float>();
      view.normals(v, u) = {n.x(), n.y(), n.z()};
    }
  }
  return view;
}

PhotometricReference referenceOf(const DepthScene& scene, const Pose& T_WC = Pose::Identity()) {
  PhotometricReference reference;
  reference.take(measured(scene, T_WC), paintedIntensity(scene, camera(), T_WC), T_WC);
  return reference;
}

NormalEquations compared(const PhotometricReference& reference, const DepthScene& scene, const Pose& truth,
                         const Pose& guess, double brightness = 0.0, std::size_t level = 0) {
  const DepthMaps depth = measured(scene, truth);
  const IntensityPyramid live = paintedIntensity(scene, camera(), truth);
  constexpr double kGate = 15.0;
  return linearizePhotometric({reference.state(), live, depth, reference.state().T_WR}, level, guess, brightness,
                              kGate);
}

TEST(Photometric, SeesNoDifferenceAtTheTruth) {
  const PhotometricReference reference = referenceOf(cornerWithBalls());
  const Pose truth = poseOf({0.2, 1, 0.1}, 2.0, {0.02, -0.01, 0.015});
  for (const std::size_t level : {0U, 1U}) {
    const NormalEquations sums = compared(reference, cornerWithBalls(), truth, truth, 0.0, level);
    EXPECT_GT(sums.inliers, 0.7 * static_cast<double>(reference.state().points.count));
    EXPECT_LT(std::sqrt(sums.weighted_square / sums.weight), level == 0 ? 2.0 : 4.0);
  }
}

TEST(Photometric, HasTheGradientOfItsOwnSumOfSquares) {
  const PhotometricReference reference = referenceOf(wall());
  const Pose truth = Pose::Identity();
  const Pose guess = poseOf({0.3, 1, 0.2}, 0.03, {0.0003, -0.0003, 0.0006});
  const NormalEquations sums = compared(reference, wall(), truth, guess);
  for (int axis = 0; axis < 6; ++axis) {
    constexpr double kStep = 2e-4;
    double cost[2];
    for (const int side : {0, 1}) {
      Vector6 step = Vector6::Zero();
      step(axis) = side == 0 ? -kStep : kStep;
      const Pose there = rigidMotion(step.head<3>(), step.tail<3>()) * guess;
      cost[side] = 0.5 * compared(reference, wall(), truth, there).weighted_square;
    }
    const double gradient = (cost[1] - cost[0]) / (2.0 * kStep);
    // Differences are small, so Tukey's weights hardly change; slopes are those of the reference, not of the live
    // image.
    EXPECT_NEAR(-sums.b(axis), gradient, 0.1 * sums.b.norm()) << axis;
  }
}

TEST(Photometric, FindsTheMotionAlongAWallThatTheSurfaceLeavesOpen) {
  const DepthScene scene = wall();
  const PhotometricReference reference = referenceOf(scene);
  const Pose truth = poseOf({0, 0, 1}, 2.0, {0.02, 0.0, 0.01});
  const IntensityPyramid live = paintedIntensity(scene, camera(), truth);
  const TrackedColor color{live, reference};
  const DepthMaps depth = measured(scene, truth);
  const Tracking alone = Tracker().track(depth, exactView(scene), Pose::Identity());
  const Tracking both = Tracker().track(depth, exactView(scene), Pose::Identity(), &color);
  EXPECT_NE(alone.status, TrackingStatus::kTracked);
  EXPECT_EQ(both.status, TrackingStatus::kTracked);
  const Pose error = truth.inverse() * both.T_WC;
  EXPECT_LT(error.translation().norm(), 0.002);
  EXPECT_LT(rotationVector(error.linear()).norm(), 0.002);
}

TEST(Photometric, DoesNotMindThatTheImageIsBrighter) {
  const DepthScene scene = wall();
  const PhotometricReference reference = referenceOf(scene);
  const Pose truth = poseOf({0, 1, 0}, 1.0, {0.015, 0.01, 0.0});
  const IntensityPyramid live = paintedIntensity(scene, camera(), truth, 8.0);
  const TrackedColor color{live, reference};
  const Tracking tracking = Tracker().track(measured(scene, truth), exactView(scene), Pose::Identity(), &color);
  EXPECT_EQ(tracking.status, TrackingStatus::kTracked);
  EXPECT_LT((truth.inverse() * tracking.T_WC).translation().norm(), 0.003);
}

TEST(Photometric, LeavesOutPointsThatAnotherSurfaceHides) {
  const PhotometricReference reference = referenceOf(wall());
  DepthScene hidden = wall();
  hidden.balls = {{{0.0, 0.0, 0.9}, 0.2}};
  const NormalEquations open = compared(reference, wall(), Pose::Identity(), Pose::Identity());
  const NormalEquations covered = compared(reference, hidden, Pose::Identity(), Pose::Identity());
  EXPECT_LT(covered.met, 0.95 * open.met);
  EXPECT_LT(std::sqrt(covered.weighted_square / covered.weight), 2.0);
}

TEST(Photometric, AsksNothingOfColourWhereThereIsNone) {
  const DepthScene scene = cornerWithBalls();
  const Pose truth = poseOf({0, 1, 0}, 2.0, {0.02, 0, 0});
  const DepthMaps depth = measured(scene, truth);
  const IntensityPyramid live = paintedIntensity(scene, camera(), truth);
  const Tracking alone = Tracker().track(depth, exactView(scene), Pose::Identity());
  const PhotometricReference none;
  const TrackedColor without{live, none};
  EXPECT_EQ(Tracker().track(depth, exactView(scene), Pose::Identity(), &without).T_WC.matrix(), alone.T_WC.matrix());
  const PhotometricReference reference = referenceOf(scene);
  const TrackedColor color{live, reference};
  TrackerConfig off;
  off.grey_levels_per_mm = 0.0;
  EXPECT_EQ(Tracker(off).track(depth, exactView(scene), Pose::Identity(), &color).T_WC.matrix(), alone.T_WC.matrix());
  EXPECT_NE(Tracker().track(depth, exactView(scene), Pose::Identity(), &color).T_WC.matrix(), alone.T_WC.matrix());
}

TEST(PhotometricReference, HoldsSlopesThatADisplacedPointConfirms) {
  const DepthScene scene = wall();
  const PhotometricReference reference = referenceOf(scene);
  const PhotometricReference::Points& points = reference.state().points;
  ASSERT_GT(points.count, 1000U);
  // A shift along the wall's first direction changes the paint by its derivative there.
  const Eigen::Vector3d along = scene.planes[0].normal.unitOrthogonal();
  constexpr double kStep_m = 1e-4;
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Eigen::Vector3d p(points.position[0][i], points.position[1][i], points.position[2][i]);
    const auto& slope = points.levels[0].slope;
    const double held = along.dot(Eigen::Vector3d(slope[0][i], slope[1][i], slope[2][i]));
    const double painted = (test::paintAt(p + kStep_m * along) - test::paintAt(p - kStep_m * along)) / (2.0 * kStep_m);
    error += (held - painted) * (held - painted);
    size += painted * painted;
  }
  EXPECT_LT(std::sqrt(error / size), 0.1);  // central differences over two pixels of waves ten pixels long
}

TEST(PhotometricReference, IsDueAfterAShiftOrATurn) {
  PhotometricReference reference;
  EXPECT_TRUE(reference.wants(Pose::Identity()));
  EXPECT_TRUE(reference.empty());
  reference = referenceOf(wall());
  const PhotometricReferenceConfig limits;
  EXPECT_FALSE(reference.wants(Pose::Identity()));
  EXPECT_FALSE(reference.wants(poseOf({0, 1, 0}, 0.0, {0.9 * limits.shift_m, 0, 0})));
  EXPECT_TRUE(reference.wants(poseOf({0, 1, 0}, 0.0, {1.1 * limits.shift_m, 0, 0})));
  const double degrees = limits.turn_rad * 57.29577951308232;
  EXPECT_FALSE(reference.wants(poseOf({0, 1, 0}, 0.9 * degrees, {0, 0, 0})));
  EXPECT_TRUE(reference.wants(poseOf({0, 1, 0}, 1.1 * degrees, {0, 0, 0})));
}

TEST(PhotometricReference, HasNoPointsWithoutTextureOrDepth) {
  PhotometricReference reference;
  IntensityPyramid flat;
  flat.build(cv::Mat3b(240, 320, cv::Vec3b::all(90)), camera());
  reference.take(measured(wall(), Pose::Identity()), flat, Pose::Identity());
  EXPECT_TRUE(reference.empty());
  EXPECT_FALSE(reference.wants(Pose::Identity()));
  DepthMaps blind;
  DepthPreparation().prepare(cv::Mat1f(240, 320, 0.0F), camera(), blind);
  reference.take(blind, paintedIntensity(wall(), camera(), Pose::Identity()), Pose::Identity());
  EXPECT_TRUE(reference.empty());
}

TEST(PhotometricReference, RefusesSettingsOutOfRange) {
  PhotometricReferenceConfig config;
  config.smallest_gradient = -1.0;
  EXPECT_THROW(PhotometricReference{config}, std::invalid_argument);
}

}  // namespace
}  // namespace saccade
