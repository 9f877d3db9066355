#include "saccade/map/surface_volume.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

using test::cornerWithBalls;
using test::DepthScene;
using test::poseOf;
using test::smallCamera;

// Exact depth, nearest pixel: a sample beside a pixel's ray takes that pixel's depth, half a pixel of slope away. With
// the small camera a pixel at 1.2 m is 8 mm; most of the surface is met better than a third of a cell.
constexpr double kTypicalDepthError_m = 0.003;
constexpr double kTypicalNormalError_rad = 0.15;
// One frame stored in 16 bits and a weight rounded to 1/128 observation.
constexpr double kFusionRounding = 2.0 / 32767.0;

DepthMaps measured(const DepthScene& scene, const Pose& T_WC) {
  DepthPreparationConfig config;
  config.smoothing_radius_px = 0;
  DepthMaps maps;
  DepthPreparation(config).prepare(scene.render(smallCamera(), T_WC), smallCamera(), maps);
  return maps;
}

double shareBelow(const std::vector<double>& errors, double limit) {
  std::size_t below = 0;
  for (const double e : errors) below += e < limit ? 1 : 0;
  return errors.empty() ? 0.0 : static_cast<double>(below) / static_cast<double>(errors.size());
}

struct Errors {
  std::vector<double> depth_m;
  std::vector<double> normal_rad;
  int holes = 0;
};

Errors compare(const ModelView& view, const DepthScene& scene) {
  Errors errors;
  for (int v = 0; v < view.depth_m.rows; ++v) {
    for (int u = 0; u < view.depth_m.cols; ++u) {
      const DepthScene::Meeting truth = scene.meetPixel(view.camera, view.T_WM, u, v);
      if (!(truth.s < 2.5)) continue;
      const auto depth = static_cast<double>(view.depth_m(v, u));
      if (depth == 0.0) {
        ++errors.holes;
        continue;
      }
      errors.depth_m.push_back(std::abs(depth - truth.s));
      const cv::Vec3f n = view.normals(v, u);
      const Eigen::Vector3d normal(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]));
      const Eigen::Vector3d expected = view.T_WM.linear().transpose() * truth.normal;
      errors.normal_rad.push_back(std::acos(std::clamp(normal.dot(expected), -1.0, 1.0)));
    }
  }
  return errors;
}

TEST(SurfaceVolume, ShowsTheSameWhereItIsWantedAndHolesElsewhere) {
  const Pose T_WC = poseOf({0, 1, 0}, 1.0, {0.01, 0.0, 0.0});
  SurfaceVolume volume;
  volume.integrate(measured(cornerWithBalls(), T_WC), T_WC);
  ModelView all, some;
  volume.rayCast(smallCamera(), T_WC, all);
  cv::Mat1b wanted(all.depth_m.size());
  for (int v = 0; v < wanted.rows; ++v) {
    for (int u = 0; u < wanted.cols; ++u) wanted(v, u) = (u / 3 + v / 5) % 2 == 0 ? 1 : 0;
  }
  volume.rayCast(smallCamera(), T_WC, some, &wanted);
  int seen = 0;
  for (int v = 0; v < wanted.rows; ++v) {
    for (int u = 0; u < wanted.cols; ++u) {
      const bool is_wanted = wanted(v, u) != 0;
      EXPECT_EQ(some.depth_m(v, u), is_wanted ? all.depth_m(v, u) : 0.0F);
      EXPECT_EQ(some.normals(v, u), is_wanted ? all.normals(v, u) : cv::Vec3f());
      seen += some.depth_m(v, u) > 0.0F ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 5000);
  const cv::Mat1b other_size(3, 4, std::uint8_t{1});
  EXPECT_THROW(volume.rayCast(smallCamera(), T_WC, some, &other_size), std::invalid_argument);
}

TEST(SurfaceVolume, ShowsAFusedBallAtItsExactDepth) {
  DepthScene scene;
  scene.balls = {{{0.05, -0.03, 1.2}, 0.4}};
  SurfaceVolume volume;
  for (int i = -2; i <= 2; ++i) {
    const Pose T_WC = poseOf({0, 1, 0}, 2.0 * i, {0.03 * i, 0.01 * i, 0.0});
    volume.integrate(measured(scene, T_WC), T_WC);
  }
  ModelView view;
  volume.rayCast(smallCamera(), poseOf({0, 1, 0}, 1.0, {0.01, 0.0, 0.0}), view);
  const Errors errors = compare(view, scene);
  EXPECT_GT(errors.depth_m.size(), 3000U);
  EXPECT_GT(shareBelow(errors.depth_m, kTypicalDepthError_m), 0.9);
  EXPECT_GT(shareBelow(errors.normal_rad, kTypicalNormalError_rad), 0.9);
}

TEST(SurfaceVolume, ShowsACornerFromPosesItWasNotSeenFrom) {
  const DepthScene scene = cornerWithBalls();
  SurfaceVolume volume;
  for (int i = -2; i <= 2; ++i) {
    const Pose T_WC = poseOf({0, 1, 0}, 1.5 * i, {0.02 * i, 0.0, 0.0});
    volume.integrate(measured(scene, T_WC), T_WC);
  }
  ModelView view;
  volume.rayCast(smallCamera().reducedBy(2), poseOf({1, 0.5, 0}, 1.0, {0.01, 0.02, 0.05}), view);
  const Errors errors = compare(view, scene);
  EXPECT_EQ(view.depth_m.cols, 80);
  EXPECT_GT(errors.depth_m.size(), 4000U);
  EXPECT_LT(errors.holes, 150);
  EXPECT_GT(shareBelow(errors.depth_m, 2 * kTypicalDepthError_m), 0.9);
  EXPECT_GT(shareBelow(errors.normal_rad, 2 * kTypicalNormalError_rad), 0.9);
}

// The rule of Newcombe et al. 2011, sample by sample in double precision.
std::optional<double> expectedDistance(const DepthMaps& depth, const Pose& T_WC, const Eigen::Vector3d& p_W,
                                       double band_m) {
  const Eigen::Vector3d p = T_WC.inverse() * p_W;
  if (p.z() <= 0.01) return std::nullopt;
  const Eigen::Vector2d pixel = depth.camera.project(p);
  const int u = static_cast<int>(std::floor(pixel.x() + 0.5)), v = static_cast<int>(std::floor(pixel.y() + 0.5));
  if (u < 0 || v < 0 || u >= depth.camera.width || v >= depth.camera.height) return std::nullopt;
  const double measured_m = static_cast<double>(depth.depth_m(v, u));
  if (measured_m == 0.0) return std::nullopt;
  const double distance = (measured_m - p.z()) * p.norm() / p.z();
  if (distance <= -band_m) return std::nullopt;
  return std::min(1.0, distance / band_m);
}

TEST(SurfaceVolume, AgreesWithBruteForceOverEverySampleOfTheBand) {
  const DepthScene scene = cornerWithBalls();
  const Pose T_WC = poseOf({0.3, 1, 0.2}, 7.0, {0.11, -0.05, 0.02});
  const DepthMaps depth = measured(scene, T_WC);
  SurfaceVolume volume;
  volume.integrate(depth, T_WC);
  const double cell = volume.config().cell_m;
  const double band = volume.config().band_cells * cell;
  std::size_t same = 0, near = 0, different = 0, missing = 0;
  for (std::size_t b = 0; b < volume.bricks().size(); ++b) {
    const BrickPosition& p = volume.bricks()[b];
    for (int i = 0; i < SurfaceBrick::kSamples; ++i) {
      const Eigen::Vector3d p_W =
          cell * Eigen::Vector3d(8 * p.x + (i & 7), 8 * p.y + ((i >> 3) & 7), 8 * p.z + (i >> 6));
      const auto expected = expectedDistance(depth, T_WC, p_W, band);
      const auto at = static_cast<std::size_t>(i);
      const bool known = volume.brick(b).weight[at] > 0;
      const double found = volume.brick(b).distance[at] / static_cast<double>(SurfaceBrick::kDistanceScale);
      if (known != expected.has_value()) {
        ++missing;
      } else if (!known || std::abs(found - *expected) < kFusionRounding) {
        ++same;
        near += known && std::abs(*expected) < 1.0 ? 1 : 0;
      } else {
        ++different;
      }
    }
  }
  EXPECT_GT(near, 50000U);
  // Float and double choose another pixel where a sample projects onto the border of two, and another side of the
  // band's end: nowhere else.
  EXPECT_LT(static_cast<double>(different + missing), 2e-4 * static_cast<double>(same));
}

TEST(SurfaceVolume, AllocatesEveryBrickThatTheBandTouches) {
  const DepthScene scene = cornerWithBalls();
  const DepthMaps depth = measured(scene, Pose::Identity());
  SurfaceVolume volume;
  volume.integrate(depth, Pose::Identity());
  int unknown = 0;
  for (int v = 0; v < depth.camera.height; v += 3) {
    for (int u = 0; u < depth.camera.width; u += 3) {
      const auto z = static_cast<double>(depth.depth_m(v, u));
      if (z == 0.0) continue;
      for (const double offset_m : {-0.02, 0.0, 0.02}) {
        unknown += volume.distanceAt(depth.camera.unproject(u, v, z + offset_m)).has_value() ? 0 : 1;
      }
    }
  }
  EXPECT_LT(unknown, 700);  // of 6 000: at the image's border and the balls' silhouettes one of eight samples is unseen
}

TEST(SurfaceVolume, AveragesObservationsByTheirWeight) {
  DepthScene near_wall, far_wall;
  near_wall.planes = {{Eigen::Vector3d(0, 0, -1), -0.805}};
  far_wall.planes = {{Eigen::Vector3d(0, 0, -1), -0.815}};
  SurfaceVolume volume;
  for (int i = 0; i < 10; ++i) {
    volume.integrate(measured(near_wall, Pose::Identity()), Pose::Identity());
    volume.integrate(measured(far_wall, Pose::Identity()), Pose::Identity());
  }
  ModelView view;
  volume.rayCast(smallCamera(), Pose::Identity(), view);
  EXPECT_NEAR(static_cast<double>(view.depth_m(60, 80)), 0.81, 1e-4);
}

TEST(SurfaceVolume, ForgetsASurfaceThatTheCameraLooksThrough) {
  DepthScene with_ball, without;
  without.planes = with_ball.planes = {{Eigen::Vector3d(0, 0, -1), -1.5}};
  with_ball.balls = {{{0, 0, 1.0}, 0.2}};
  SurfaceVolume volume;
  for (int i = 0; i < 3; ++i) volume.integrate(measured(with_ball, Pose::Identity()), Pose::Identity());
  ModelView view;
  volume.rayCast(smallCamera(), Pose::Identity(), view);
  EXPECT_NEAR(static_cast<double>(view.depth_m(60, 80)), 0.8, kTypicalDepthError_m);
  for (int i = 0; i < 60; ++i) volume.integrate(measured(without, Pose::Identity()), Pose::Identity());
  volume.rayCast(smallCamera(), Pose::Identity(), view);
  EXPECT_NEAR(static_cast<double>(view.depth_m(60, 80)), 1.5, kTypicalDepthError_m);
}

TEST(SurfaceVolume, GivesTheSameViewAfterEveryBrickWasImported) {
  const DepthScene scene = cornerWithBalls();
  SurfaceVolume volume, copy;
  volume.integrate(measured(scene, Pose::Identity()), Pose::Identity());
  for (std::size_t i = volume.bricks().size(); i-- > 0;) copy.importBrick(volume.bricks()[i], volume.brick(i));
  const Pose T_WM = poseOf({0, 1, 0}, 3.0, {0.05, 0, 0});
  ModelView view, copied;
  volume.rayCast(smallCamera(), T_WM, view);
  copy.rayCast(smallCamera(), T_WM, copied);
  EXPECT_GT(cv::countNonZero(view.depth_m), 10000);
  EXPECT_EQ(cv::norm(view.depth_m, copied.depth_m, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(view.normals, copied.normals, cv::NORM_INF), 0.0);
}

TEST(SurfaceVolume, SaysWhichBricksChanged) {
  DepthScene scene;
  scene.planes = {{Eigen::Vector3d(0, 0, -1), -1.0}};
  SurfaceVolume volume;
  volume.integrate(measured(scene, Pose::Identity()), Pose::Identity());
  const std::uint64_t saved = volume.changes();
  const std::size_t first = volume.bricks().size();
  volume.integrate(measured(scene, Pose::Identity()), poseOf({0, 1, 0}, 180.0, {0, 0, 0}));  // looks the other way
  EXPECT_GT(volume.bricks().size(), first);
  for (std::size_t i = 0; i < volume.bricks().size(); ++i) {
    if (i < first) {
      EXPECT_LE(volume.lastChange(i), saved);
    }
  }
}

TEST(SurfaceVolume, RepeatsItsBytes) {
  const auto run = [] {
    SurfaceVolume volume;
    ModelView view;
    for (int i = 0; i < 3; ++i) {
      const Pose T_WC = poseOf({0, 1, 0}, i, {0.01 * i, 0, 0});
      volume.integrate(measured(cornerWithBalls(), T_WC), T_WC);
      volume.rayCast(smallCamera(), T_WC, view);
    }
    return view;
  };
  const ModelView a = run(), b = run();
  EXPECT_EQ(cv::norm(a.depth_m, b.depth_m, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(a.normals, b.normals, cv::NORM_INF), 0.0);
}

TEST(SurfaceVolume, ShowsNothingWhereNothingWasMeasured) {
  SurfaceVolume volume;
  ModelView view;
  volume.rayCast(smallCamera(), Pose::Identity(), view);
  EXPECT_EQ(cv::countNonZero(view.depth_m), 0);
  DepthMaps empty;
  DepthPreparation().prepare(cv::Mat1f(120, 160, std::numeric_limits<float>::quiet_NaN()), smallCamera(), empty);
  volume.integrate(empty, Pose::Identity());
  EXPECT_TRUE(volume.empty());
  DepthMaps far;
  DepthPreparation().prepare(cv::Mat1f(120, 160, 9.0F), smallCamera(), far);
  volume.integrate(far, Pose::Identity());
  EXPECT_TRUE(volume.empty());
  EXPECT_FALSE(volume.distanceAt({0, 0, 1}).has_value());
}

TEST(SurfaceVolume, SurvivesACameraInsideOrBehindTheSurface) {
  const DepthScene scene = cornerWithBalls();
  SurfaceVolume volume;
  volume.integrate(measured(scene, Pose::Identity()), Pose::Identity());
  ModelView view;
  for (const double z : {1.02, 1.06, 1.3, 3.0, -2.0, -50.0, 5e4}) {
    volume.rayCast(smallCamera(), poseOf({0, 1, 0}, 0.0, {-0.3, 0.4, z}), view);
    EXPECT_TRUE(cv::checkRange(view.depth_m)) << z;
    EXPECT_TRUE(cv::checkRange(view.normals)) << z;
  }
  volume.rayCast(smallCamera(), poseOf({0, 1, 0}, 180.0, {0, 0, 3.0}), view);  // only ever sees backs
  EXPECT_LT(cv::countNonZero(view.depth_m), 600);  // 3 %: fronts of the balls, seen past the corner's edges
}

TEST(SurfaceVolume, RefusesBadPosesAndConfigurations) {
  SurfaceVolume volume;
  ModelView view;
  Pose bad = Pose::Identity();
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(volume.rayCast(smallCamera(), bad, view), std::invalid_argument);
  EXPECT_THROW(volume.integrate(measured(cornerWithBalls(), Pose::Identity()), bad), std::invalid_argument);
  bad.translation().x() = 1e9;
  EXPECT_THROW(volume.rayCast(smallCamera(), bad, view), std::invalid_argument);
  SurfaceVolumeConfig config;
  config.cell_m = 0.0;
  EXPECT_THROW(SurfaceVolume{config}, std::invalid_argument);
}

TEST(SurfaceVolume, BricksThatWereRemovedComeBackAsTheyWereAndTheirRoomIsUsedAgain) {
  const DepthScene scene = cornerWithBalls();
  const Pose T_WC = Pose::Identity();
  SurfaceVolume volume;
  for (int i = 0; i < 3; ++i) volume.integrate(measured(scene, T_WC), T_WC);
  ModelView before, after;
  volume.rayCast(smallCamera(), T_WC, before);
  const std::size_t bytes = volume.memoryBytes(), used = volume.usedBytes(), bricks = volume.bricks().size();
  std::vector<std::pair<BrickPosition, SurfaceBrick>> away;
  volume.removeBricks([&](std::size_t i) {
    if (volume.bricks()[i].x % 2 == 0) return false;
    away.emplace_back(volume.bricks()[i], volume.brick(i));
    return true;
  });
  ASSERT_GT(away.size(), 10U);
  ASSERT_EQ(volume.bricks().size() + away.size(), bricks);
  EXPECT_EQ(volume.usedBytes(), used - away.size() * sizeof(SurfaceBrick));
  for (const BrickPosition& brick : volume.bricks()) EXPECT_EQ(brick.x % 2, 0);

  const std::uint64_t changes = volume.changes();
  for (const auto& [position, brick] : away) volume.returnBrick(position, brick);
  EXPECT_THROW(volume.returnBrick(away[0].first, away[0].second), std::logic_error);
  EXPECT_EQ(volume.changes(), changes);
  EXPECT_EQ(volume.lastChange(bricks - 1), 0U);
  EXPECT_LE(volume.memoryBytes(), bytes);
  volume.rayCast(smallCamera(), T_WC, after);
  EXPECT_EQ(cv::norm(before.depth_m, after.depth_m, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(before.normals, after.normals, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace saccade
