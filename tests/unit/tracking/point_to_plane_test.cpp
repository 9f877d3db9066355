#include "tracking/point_to_plane.hpp"

#include <gtest/gtest.h>

#include "support/depth_scene.hpp"
#include "tracking/rigid_motion.hpp"

namespace saccade {
namespace {

using test::cornerWithBalls;
using test::poseOf;
using test::smallCamera;

// A gate so wide that every point pairs and Tukey's weight is constant: the sum is then a plain sum of squares.
constexpr PairingGates kOpen{1000.0, -1.1};
// Central differences of a float-valued sum with steps of 1e-3; the second derivatives of a Gauss-Newton model leave
// out the curvature of the residual.
constexpr double kGradientError = 0.02;

DepthMaps measured(const Pose& T_WC) {
  DepthMaps maps;
  DepthPreparation().prepare(cornerWithBalls().render(smallCamera(), T_WC), smallCamera(), maps);
  return maps;
}

// One plane for the whole view: pairs may change pixel without a change of the residual.
ModelView wall() {
  test::DepthScene scene;
  scene.planes = {{Eigen::Vector3d(0.2, -0.3, -0.9).normalized(), -1.5}};
  ModelView view;
  view.camera = smallCamera();
  view.depth_m = scene.render(view.camera, Pose::Identity());
  const Eigen::Vector3f n = scene.planes[0].normal.cast<float>();
  view.normals = cv::Mat3f(view.depth_m.size(), cv::Vec3f(n.x(), n.y(), n.z()));
  return view;
}

TEST(PointToPlane, HasTheGradientOfItsOwnSumOfSquares) {
  const DepthMaps depth = measured(Pose::Identity());
  const ModelView model = wall();
  LivePoints points;
  points.select(depth, 2);
  const Pose T = poseOf({0.2, 1, 0.1}, 1.0, {0.01, -0.02, 0.015});
  const NormalEquations sums = linearize(points, model, T, kOpen);
  for (int axis = 0; axis < 6; ++axis) {
    constexpr double kStep = 1e-3;
    double cost[2];
    for (const int side : {0, 1}) {
      Vector6 step = Vector6::Zero();
      step(axis) = side == 0 ? -kStep : kStep;
      const NormalEquations there = linearize(points, model, rigidMotion(step.head<3>(), step.tail<3>()) * T, kOpen);
      EXPECT_EQ(there.inliers, sums.inliers);
      cost[side] = 0.5 * there.weighted_square;
    }
    const double gradient = (cost[1] - cost[0]) / (2.0 * kStep);
    EXPECT_NEAR(-sums.b(axis), gradient, kGradientError * sums.b.norm()) << axis;
  }
}

TEST(PointToPlane, LeavesOutPointsBeyondTheGates) {
  const DepthMaps depth = measured(Pose::Identity());
  ModelView model = wall();
  LivePoints points;
  points.select(depth, 2);
  const NormalEquations near = linearize(points, model, Pose::Identity(), {0.02, 0.8});
  EXPECT_LT(near.inliers, near.met);
  EXPECT_LE(near.weighted_square, near.weight * 0.02 * 0.02);
  model.normals.setTo(cv::Scalar(1.0, 0.0, 0.0));
  const NormalEquations turned = linearize(points, model, Pose::Identity(), {1000.0, 0.999});
  EXPECT_EQ(turned.inliers, 0.0);
  EXPECT_EQ(turned.near, turned.met);
}

// Turns every normal by its own angle of about `noise` radians.
void addNoise(cv::Mat3f& normals, double noise, std::uint64_t seed) {
  cv::RNG random(seed);
  for (cv::Vec3f& n : normals) {
    if (n[2] == 0.0F) continue;
    for (int axis = 0; axis < 3; ++axis) n[axis] += static_cast<float>(random.gaussian(noise));
    n /= static_cast<float>(cv::norm(n));
  }
}

TEST(PointToPlane, DoesNotTakeNoiseInTheNormalsForStructureOfTheSurface) {
  constexpr double kNoise_rad = 0.05;
  test::DepthScene scene;
  scene.planes = {{Eigen::Vector3d(0.2, -0.3, -0.9).normalized(), -1.5}};
  DepthMaps depth;
  DepthPreparation().prepare(scene.render(smallCamera(), Pose::Identity()), smallCamera(), depth);
  ModelView model = wall();
  addNoise(model.normals, kNoise_rad, 1);
  addNoise(depth.normals, kNoise_rad, 2);
  LivePoints points;
  points.select(depth, 2);
  const NormalEquations sums = linearize(points, model, Pose::Identity(), {0.05, 0.5});
  const Matrix6 with_noise = sums.H / sums.weight;
  const Matrix6 without = noiseFreeInformation(points, model, Pose::Identity(), {0.05, 0.5});
  // A shift along the wall cannot be seen: all that H has to say about it is the square of the noise.
  Vector6 along = Vector6::Zero();
  along.tail<3>() = Eigen::Vector3d(0.2, -0.3, -0.9).normalized().unitOrthogonal();
  EXPECT_NEAR(along.dot(with_noise * along), kNoise_rad * kNoise_rad, 0.3 * kNoise_rad * kNoise_rad);
  EXPECT_LT(std::abs(along.dot(without * along)), 0.2 * kNoise_rad * kNoise_rad);
}

TEST(PointToPlane, CountsNothingWhereTheModelHasNoSurface) {
  const DepthMaps depth = measured(Pose::Identity());
  ModelView model = wall();
  model.depth_m.setTo(0.0F);
  model.normals.setTo(cv::Scalar::all(0.0));
  LivePoints points;
  points.select(depth, 2);
  const NormalEquations sums = linearize(points, model, Pose::Identity(), kOpen);
  EXPECT_GT(points.count, 1000U);
  EXPECT_EQ(sums.met, 0.0);
  EXPECT_EQ(sums.weight, 0.0);
}

}  // namespace
}  // namespace saccade
