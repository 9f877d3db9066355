#include "saccade/core/depth_maps.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

using test::DepthScene;
using test::smallCamera;

// On a plane the inverse depth is exactly linear: what is left is the rounding of float inverse depths.
constexpr double kPlaneNormalError_rad = 1e-3;
constexpr double kPlaneVertexError_m = 1e-5;
// Over a window of 9 pixels a ball of 0.25 m at 1.2 m is not a plane.
constexpr double kBallNormalError_rad = 0.06;

DepthScene slantedPlane() {
  DepthScene scene;
  scene.planes = {{Eigen::Vector3d(0.3, -0.5, -0.8).normalized(), -1.5}};
  return scene;
}

Eigen::Vector3d toEigen(const cv::Vec3f& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

DepthMaps prepared(const cv::Mat1f& depth_m, const DepthPreparationConfig& config = {}) {
  DepthMaps maps;
  DepthPreparation(config).prepare(depth_m, smallCamera(), maps);
  return maps;
}

TEST(DepthPreparation, GivesExactVerticesAndNormalsOnASlantedPlane) {
  const DepthScene scene = slantedPlane();
  const DepthMaps maps = prepared(scene.render(smallCamera(), Pose::Identity()));
  int normals = 0;
  for (int v = 0; v < maps.depth_m.rows; ++v) {
    for (int u = 0; u < maps.depth_m.cols; ++u) {
      if (maps.depth_m(v, u) == 0.0F) continue;  // beyond the range
      const double depth = static_cast<double>(maps.depth_m(v, u));
      const Eigen::Vector3d vertex = toEigen(maps.vertices(v, u));
      EXPECT_LT((vertex - smallCamera().unproject(u, v, depth)).norm(), kPlaneVertexError_m * depth * depth);
      const Eigen::Vector3d normal = toEigen(maps.normals(v, u));
      if (normal.isZero()) continue;
      ++normals;
      EXPECT_LT(normal.dot(vertex), 0.0);
      EXPECT_LT(std::acos(std::min(1.0, normal.dot(scene.planes[0].normal))), kPlaneNormalError_rad);
    }
  }
  EXPECT_GT(normals, 10000);
}

TEST(DepthPreparation, GivesTheNormalsOfABall) {
  DepthScene scene;
  scene.balls = {{{0.05, -0.02, 1.2}, 0.25}};
  const DepthMaps maps = prepared(scene.render(smallCamera(), Pose::Identity()));
  int normals = 0;
  for (int v = 0; v < maps.depth_m.rows; ++v) {
    for (int u = 0; u < maps.depth_m.cols; ++u) {
      const Eigen::Vector3d normal = toEigen(maps.normals(v, u));
      const Eigen::Vector3d truth = scene.meetPixel(smallCamera(), Pose::Identity(), u, v).normal;
      if (normal.isZero() || std::abs(truth.z()) < 0.5) continue;  // flat angles: the window spans too much of the ball
      ++normals;
      EXPECT_LT(std::acos(std::min(1.0, normal.dot(truth))), kBallNormalError_rad) << u << " " << v;
    }
  }
  EXPECT_GT(normals, 1000);
}

TEST(DepthPreparation, NeverLetsANormalCrossADepthDiscontinuity) {
  DepthScene scene;  // a ball's silhouette before a wall that faces the camera
  scene.planes = {{Eigen::Vector3d(0.0, 0.0, -1.0), -2.0}};
  cv::Mat1f depth = scene.render(smallCamera(), Pose::Identity());
  depth(cv::Rect(40, 30, 60, 50)) = 1.0F;  // a card that hovers before it
  const DepthMaps maps = prepared(depth);
  for (int v = 0; v < maps.depth_m.rows; ++v) {
    for (int u = 0; u < maps.depth_m.cols; ++u) {
      const Eigen::Vector3d normal = toEigen(maps.normals(v, u));
      EXPECT_FLOAT_EQ(maps.vertices(v, u)[2], depth(v, u));  // nor does the smoothing mix both sides
      if (!normal.isZero()) {
        EXPECT_LT((normal - Eigen::Vector3d(0.0, 0.0, -1.0)).norm(), kPlaneNormalError_rad);
      }
    }
  }
  EXPECT_TRUE(toEigen(maps.normals(50, 40)).isZero());
  EXPECT_FALSE(toEigen(maps.normals(50, 45)).isZero());
}

TEST(DepthPreparation, TakesInvalidValuesAndThoseOutOfRangeAsNoMeasurement) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  cv::Mat1f depth(120, 160, 1.0F);
  const float bad[] = {nan, infinite, -infinite, -1.0F, 0.0F, 0.29F, 4.01F, 1e30F};
  for (int i = 0; i < 8; ++i) depth(60, 10 + 15 * i) = bad[i];
  const DepthMaps maps = prepared(depth);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(maps.depth_m(60, 10 + 15 * i), 0.0F) << bad[i];
    EXPECT_EQ(maps.vertices(60, 10 + 15 * i), cv::Vec3f(0, 0, 0)) << bad[i];
    EXPECT_EQ(maps.normals(60, 10 + 15 * i), cv::Vec3f(0, 0, 0)) << bad[i];
  }
  EXPECT_NEAR(static_cast<double>(maps.vertices(60, 12)[2]), 1.0, kPlaneVertexError_m);
  EXPECT_EQ(cv::countNonZero(maps.depth_m), 120 * 160 - 8);
  EXPECT_TRUE(cv::checkRange(maps.vertices));
  EXPECT_TRUE(cv::checkRange(maps.normals));
}

TEST(DepthPreparation, SmoothsNoiseButNotTheMeasurementItself) {
  cv::Mat1f depth(120, 160);
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) depth(v, u) = (u + v) % 2 == 0 ? 1.002F : 0.998F;
  }
  const DepthMaps maps = prepared(depth);
  EXPECT_EQ(maps.depth_m(60, 80), depth(60, 80));
  EXPECT_LT(std::abs(maps.vertices(60, 80)[2] - 1.0F), 0.0007F);  // a third of the noise at most
  DepthPreparationConfig raw;
  raw.smoothing_radius_px = 0;
  EXPECT_NEAR(static_cast<double>(prepared(depth, raw).vertices(60, 80)[2]), 1.002, kPlaneVertexError_m);
}

TEST(DepthPreparation, ReusesTheBuffersItIsGivenAndRepeatsItsBytes) {
  const cv::Mat1f depth = slantedPlane().render(smallCamera(), Pose::Identity());
  DepthPreparation preparation;
  DepthMaps maps;
  preparation.prepare(depth, smallCamera(), maps);
  const uchar* buffer = maps.normals.data;
  const cv::Mat3f first = maps.normals.clone();
  preparation.prepare(cv::Mat1f(120, 160, 1.0F), smallCamera(), maps);
  preparation.prepare(depth, smallCamera(), maps);
  EXPECT_EQ(maps.normals.data, buffer);
  EXPECT_EQ(cv::norm(first, maps.normals, cv::NORM_INF), 0.0);
}

TEST(DepthPreparation, RefusesAnImageOfAnotherSizeAndAnEmptyRange) {
  DepthMaps maps;
  EXPECT_THROW(DepthPreparation().prepare(cv::Mat1f(10, 10, 1.0F), smallCamera(), maps), std::invalid_argument);
  DepthPreparationConfig config;
  config.min_range_m = 5.0;
  EXPECT_THROW(DepthPreparation{config}, std::invalid_argument);
}

}  // namespace
}  // namespace saccade
