#include "saccade/tracking/tracker.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/map/surface_volume.hpp"
#include "support/depth_scene.hpp"
#include "tracking/rigid_motion.hpp"

namespace saccade {
namespace {

using test::cornerWithBalls;
using test::DepthScene;
using test::poseOf;

// Exact depth of 320x240 pixels against a view of exact depth and normals: what is left is that pixels are not points.
constexpr double kExactError_m = 0.0015;
constexpr double kExactError_rad = 0.0015;
// The same against a volume of 1 cm cells.
constexpr double kVolumeError_m = 0.004;
constexpr double kVolumeError_rad = 0.004;

PinholeCamera camera() {
  return {320, 240, 292.5, 292.5, 159.5, 119.5};
}

DepthMaps measured(const DepthScene& scene, const Pose& T_WC) {
  DepthMaps maps;
  DepthPreparation().prepare(scene.render(camera(), T_WC), camera(), maps);
  return maps;
}

ModelView exactView(const DepthScene& scene, const Pose& T_WM) {
  ModelView view;
  view.camera = camera().reducedBy(2);
  view.T_WM = T_WM;
  view.depth_m = scene.render(view.camera, T_WM);
  view.normals = cv::Mat3f(view.depth_m.size(), cv::Vec3f(0, 0, 0));
  for (int v = 0; v < view.depth_m.rows; ++v) {
    for (int u = 0; u < view.depth_m.cols; ++u) {
      const Eigen::Vector3f n =
          (T_WM.linear().transpose() * scene.meetPixel(view.camera, T_WM, u, v).normal).cast<float>();
      if (view.depth_m(v, u) > 0.0F) view.normals(v, u) = {n.x(), n.y(), n.z()};
    }
  }
  return view;
}

double shiftBetween(const Pose& a, const Pose& b) {
  return (a.inverse() * b).translation().norm();
}
double turnBetween(const Pose& a, const Pose& b) {
  return rotationVector((a.inverse() * b).linear()).norm();
}

TEST(Tracker, RecoversKnownMotions) {
  const DepthScene scene = cornerWithBalls();
  const ModelView model = exactView(scene, Pose::Identity());
  Tracker tracker;
  const Pose truths[] = {Pose::Identity(), poseOf({0, 1, 0}, 2.0, {0.02, 0.0, 0.01}),
                         poseOf({1, 0.2, 0}, -3.0, {-0.02, 0.03, 0.0}), poseOf({0.1, 0.2, 1}, 4.0, {0.0, -0.02, -0.04}),
                         poseOf({1, 1, 1}, 1.0, {0.05, 0.0, 0.0})};
  for (const Pose& truth : truths) {
    const Tracking tracking = tracker.track(measured(scene, truth), model, Pose::Identity());
    EXPECT_EQ(tracking.status, TrackingStatus::kTracked);
    EXPECT_LT(shiftBetween(tracking.T_WC, truth), kExactError_m);
    EXPECT_LT(turnBetween(tracking.T_WC, truth), kExactError_rad);
    EXPECT_GT(tracking.inlier_share, 0.8);
    EXPECT_LT(tracking.rms_m, 0.005);
  }
}

TEST(Tracker, FindsTheInverseMotionBackwards) {
  const DepthScene scene = cornerWithBalls();
  const Pose there = poseOf({0.3, 1, 0}, 2.5, {0.03, -0.01, 0.02});
  Tracker tracker;
  const Tracking forward = tracker.track(measured(scene, there), exactView(scene, Pose::Identity()), Pose::Identity());
  // The frame at identity against the model seen from `there`, in a world whose origin is `there`.
  ModelView from_there = exactView(scene, there);
  from_there.T_WM = Pose::Identity();
  const Tracking back = tracker.track(measured(scene, Pose::Identity()), from_there, Pose::Identity());
  const Pose both = forward.T_WC * back.T_WC;
  EXPECT_LT(shiftBetween(both, Pose::Identity()), 2 * kExactError_m);
  EXPECT_LT(turnBetween(both, Pose::Identity()), 2 * kExactError_rad);
}

TEST(Tracker, FollowsACameraAgainstAFusedVolume) {
  const DepthScene scene = cornerWithBalls();
  SurfaceVolume volume;
  Tracker tracker;
  ModelView view;
  Pose estimate = Pose::Identity();
  for (int i = 0; i < 15; ++i) {
    const Pose truth = poseOf({0.1, 1, 0.05}, 0.8 * i, {0.012 * i, 0.004 * i, -0.005 * i});
    const DepthMaps depth = measured(scene, truth);
    if (i > 0) {
      volume.rayCast(camera().reducedBy(2), estimate, view);
      const Tracking tracking = tracker.track(depth, view, estimate);
      ASSERT_EQ(tracking.status, TrackingStatus::kTracked) << i;
      estimate = tracking.T_WC;
      EXPECT_LT(shiftBetween(estimate, truth), kVolumeError_m) << i;
      EXPECT_LT(turnBetween(estimate, truth), kVolumeError_rad) << i;
    }
    volume.integrate(depth, estimate);
  }
}

TEST(Tracker, NoticesThatASinglePlaneLeavesMotionsOpen) {
  DepthScene wall;
  wall.planes = {{Eigen::Vector3d(0.1, 0.2, -1.0).normalized(), -1.4}};
  const ModelView model = exactView(wall, Pose::Identity());
  const Pose truth = poseOf({0, 0, 1}, 2.0, {0.03, 0.0, 0.01});  // slides along the wall and comes nearer
  const Tracking tracking = Tracker().track(measured(wall, truth), model, Pose::Identity());
  EXPECT_NE(tracking.status, TrackingStatus::kTracked);
  EXPECT_LT(tracking.smallest_eigenvalue, 1e-4);
  // In the open directions it must not have drifted off; along the wall's normal it may follow.
  const Eigen::Vector3d n = wall.planes[0].normal;
  const Eigen::Vector3d shift = tracking.T_WC.translation();
  EXPECT_LT((shift - n * n.dot(shift)).norm(), 0.005);
}

TEST(Tracker, NoticesThatACornerOfTwoPlanesLeavesItsEdgeOpen) {
  DepthScene scene;
  scene.planes = {{Eigen::Vector3d(-0.7, 0.0, -0.7).normalized(), -1.2},
                  {Eigen::Vector3d(0.7, 0.0, -0.7).normalized(), -1.2}};
  const ModelView model = exactView(scene, Pose::Identity());
  const Pose truth = poseOf({0, 1, 0}, 1.0, {0.01, 0.03, 0.0});
  const Tracking tracking = Tracker().track(measured(scene, truth), model, Pose::Identity());
  EXPECT_EQ(tracking.status, TrackingStatus::kWeak);
  EXPECT_LT(std::abs(tracking.T_WC.translation().x() - 0.01), 0.003);  // the directions that are fixed are found
  EXPECT_LT(std::abs(tracking.T_WC.translation().y()), 0.003);         // the open one stays at the prediction
}

TEST(Tracker, IsLostWithoutDepthOrWithoutModelAndSaysThePrediction) {
  const DepthScene scene = cornerWithBalls();
  const Pose prediction = poseOf({0, 1, 0}, 3.0, {0.1, 0, 0});
  Tracker tracker;
  DepthMaps empty;
  DepthPreparation().prepare(cv::Mat1f(240, 320, std::numeric_limits<float>::quiet_NaN()), camera(), empty);
  const Tracking blind = tracker.track(empty, exactView(scene, Pose::Identity()), prediction);
  EXPECT_EQ(blind.status, TrackingStatus::kLost);
  EXPECT_EQ(blind.inliers, 0);
  EXPECT_EQ(shiftBetween(blind.T_WC, prediction), 0.0);
  ModelView nothing;
  SurfaceVolume().rayCast(camera(), Pose::Identity(), nothing);
  EXPECT_EQ(tracker.track(measured(scene, Pose::Identity()), nothing, prediction).status, TrackingStatus::kLost);
}

TEST(Tracker, IsLostInAnotherPlace) {
  const DepthScene scene = cornerWithBalls();
  const Pose elsewhere = poseOf({0, 1, 0}, 75.0, {0.4, 0, -0.3});
  const Tracking tracking =
      Tracker().track(measured(scene, elsewhere), exactView(scene, Pose::Identity()), Pose::Identity());
  EXPECT_NE(tracking.status, TrackingStatus::kTracked);
}

TEST(Tracker, RepeatsItsBytesWhateverItTrackedBefore) {
  const DepthScene scene = cornerWithBalls();
  const ModelView model = exactView(scene, Pose::Identity());
  const DepthMaps depth = measured(scene, poseOf({0, 1, 0}, 2.0, {0.02, 0, 0}));
  Tracker used;
  (void)used.track(measured(scene, poseOf({1, 0, 0}, 5.0, {0, 0.1, 0})), model, Pose::Identity());
  const Tracking a = used.track(depth, model, Pose::Identity());
  const Tracking b = Tracker().track(depth, model, Pose::Identity());
  EXPECT_EQ((a.T_WC.matrix() - b.T_WC.matrix()).norm(), 0.0);
  EXPECT_EQ(a.rms_m, b.rms_m);
}

TEST(Tracker, RefusesAPredictionThatIsNotFinite) {
  Pose bad = Pose::Identity();
  bad.translation().x() = std::numeric_limits<double>::infinity();
  const DepthScene scene = cornerWithBalls();
  EXPECT_THROW((void)Tracker().track(measured(scene, Pose::Identity()), exactView(scene, Pose::Identity()), bad),
               std::invalid_argument);
}

}  // namespace
}  // namespace saccade
