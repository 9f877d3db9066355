#include "saccade/rendering/depth_completion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

using test::cornerWithBalls;
using test::DepthScene;
using test::poseOf;

/// Half a Kinect's resolution, same field of view.
PinholeCamera camera() {
  return {320, 240, 292.5, 292.5, 159.5, 119.5};
}

const cv::Rect kSeen(67, 22, 203, 185);  // what the depth camera sees of the image
const cv::Rect kGap(120, 80, 40, 40);    // in which it finds nothing

bool isSeen(int u, int v) {
  return kSeen.contains({u, v}) && !kGap.contains({u, v});
}

DepthMaps mapsOf(const cv::Mat1f& depth_m) {
  DepthMaps maps;
  DepthPreparation().prepare(depth_m, camera(), maps);
  return maps;
}

/// The scene from `T_WC` by a depth camera that sees less than the image.
DepthMaps measure(const DepthScene& scene, const Pose& T_WC) {
  cv::Mat1f depth_m = scene.render(camera(), T_WC);
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      if (!isSeen(u, v)) depth_m(v, u) = 0.0F;
    }
  }
  return mapsOf(depth_m);
}

/// The surface after looks at the scene, with all of the image, from around the world's origin.
SurfaceVolume lookAround(const DepthScene& scene) {
  SurfaceVolume surface;
  for (int i = -2; i <= 2; ++i) {
    const Pose T_WC = poseOf({0.2, 1, 0}, 3.0 * i, {0.02 * i, 0.01 * i, 0.0});
    surface.integrate(mapsOf(scene.render(camera(), T_WC)), T_WC);
  }
  return surface;
}

cv::Mat1b differing(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat1b different(a.size(), std::uint8_t{0});
  for (int v = 0; v < a.rows; ++v) {
    for (int u = 0; u < a.cols; ++u) {
      different(v, u) = !std::equal(a.ptr(v, u), a.ptr(v, u) + a.elemSize(), b.ptr(v, u)) ? 1 : 0;
    }
  }
  return different;
}

TEST(DepthCompletion, ContinuesTheDepthIntoTheStripsByWhatWasSeenBefore) {
  const DepthScene scene = cornerWithBalls();
  const Pose T_WC = poseOf({0, 1, 0}, 1.0, {0.01, 0.0, 0.0});
  const DepthMaps measured = measure(scene, T_WC);
  DepthMaps completed;
  ASSERT_TRUE(DepthCompletion().complete(measured, lookAround(scene), T_WC, completed));
  EXPECT_EQ(completed.camera, measured.camera);
  std::vector<double> depth_errors, normal_errors;
  int strip = 0, filled = 0;
  for (int v = 0; v < measured.depth_m.rows; ++v) {
    for (int u = 0; u < measured.depth_m.cols; ++u) {
      if (kSeen.contains({u, v})) continue;
      ++strip;
      const auto depth = static_cast<double>(completed.depth_m(v, u));
      if (depth == 0.0) continue;
      ++filled;
      const DepthScene::Meeting truth = scene.meetPixel(camera(), T_WC, u, v);
      depth_errors.push_back(std::abs(depth - truth.s));
      const cv::Vec3f n = completed.normals(v, u), p = completed.vertices(v, u);
      const Eigen::Vector3d normal(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]));
      normal_errors.push_back(std::acos(std::clamp(normal.dot(T_WC.linear().transpose() * truth.normal), -1.0, 1.0)));
      const Eigen::Vector3d expected = camera().unproject(u, v, depth);
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(static_cast<double>(p[axis]), expected[axis], 1e-5);
    }
  }
  EXPECT_GT(filled, 0.9 * strip);
  std::sort(depth_errors.begin(), depth_errors.end());
  std::sort(normal_errors.begin(), normal_errors.end());
  // A pixel of this camera is 4 mm wide at 1.2 m, one of the model's view 16 mm.
  EXPECT_LT(depth_errors[depth_errors.size() / 2], 0.003);
  EXPECT_LT(depth_errors[depth_errors.size() * 9 / 10], 0.015);
  EXPECT_LT(normal_errors[normal_errors.size() / 2], 0.15);  // as of a view of the surface by itself
}

TEST(DepthCompletion, LeavesWhatIsMeasuredAndGapsFurtherInside) {
  const DepthScene scene = cornerWithBalls();
  const DepthMaps measured = measure(scene, Pose::Identity());
  DepthMaps completed;
  ASSERT_TRUE(DepthCompletion().complete(measured, lookAround(scene), Pose::Identity(), completed));
  cv::Mat1b changed = differing(measured.depth_m, completed.depth_m);
  changed |= differing(measured.vertices, completed.vertices);
  changed |= differing(measured.normals, completed.normals);
  EXPECT_EQ(cv::countNonZero(changed(kSeen)), 0);
  EXPECT_GT(cv::countNonZero(changed), 0);
}

/// Between a plane's neighbouring pixels nothing steps, though the surface is looked at with less resolution.
TEST(DepthCompletion, ShowsASlantedPlaneWithoutSteps) {
  DepthScene scene;
  scene.planes = {{Eigen::Vector3d(0.7, 0.0, -0.7).normalized(), -1.0}};
  const DepthMaps measured = measure(scene, Pose::Identity());
  DepthMaps completed;
  ASSERT_TRUE(DepthCompletion().complete(measured, lookAround(scene), Pose::Identity(), completed));
  for (int v = 40; v < 200; ++v) {
    for (int u = 12; u < kSeen.x - 8; ++u) {
      const double before = 1.0 / static_cast<double>(completed.depth_m(v, u - 1));
      const double at = 1.0 / static_cast<double>(completed.depth_m(v, u));
      const double after = 1.0 / static_cast<double>(completed.depth_m(v, u + 1));
      EXPECT_NEAR(before + after - 2.0 * at, 0.0, 0.003) << u << ", " << v;  // linear in u; steps of 4 px: 0.01
      EXPECT_GT(before - after, 0.0) << u << ", " << v;  // every pixel nearer or farther than the one before
    }
  }
}

TEST(DepthCompletion, TouchesNothingWhereThereIsNothingToAdd) {
  const DepthScene scene = cornerWithBalls();
  const Pose T_WC = Pose::Identity();
  const SurfaceVolume surface = lookAround(scene);
  const DepthMaps measured = measure(scene, T_WC);
  DepthMaps completed;
  completed.depth_m = cv::Mat1f(1, 1, 7.0F);
  DepthCompletion completion;
  EXPECT_FALSE(completion.complete(measured, SurfaceVolume(), T_WC, completed)) << "no surface";
  EXPECT_FALSE(completion.complete(mapsOf(scene.render(camera(), T_WC)), surface, T_WC, completed)) << "no strips";
  const Pose away = poseOf({0, 1, 0}, 180.0, {0, 0, 0});
  EXPECT_FALSE(completion.complete(measured, surface, away, completed)) << "never looked there";
  DepthCompletionConfig off;
  off.enabled = false;
  EXPECT_FALSE(DepthCompletion(off).complete(measured, surface, T_WC, completed)) << "switched off";
  EXPECT_EQ(completed.depth_m.size(), cv::Size(1, 1));
  EXPECT_EQ(completed.depth_m(0, 0), 7.0F);
}

TEST(DepthCompletion, TakesAFrameWithoutAnyMeasurementAsOneStrip) {
  const DepthScene scene = cornerWithBalls();
  const DepthMaps blind = mapsOf(cv::Mat1f(camera().height, camera().width, 0.0F));
  DepthMaps completed;
  ASSERT_TRUE(DepthCompletion().complete(blind, lookAround(scene), Pose::Identity(), completed));
  EXPECT_GT(cv::countNonZero(completed.depth_m), 0.9 * static_cast<double>(completed.depth_m.total()));
}

TEST(DepthCompletion, WorksOnImagesOfOddSize) {
  const DepthScene scene = cornerWithBalls();
  PinholeCamera odd = camera();
  odd.width -= 3;
  odd.height -= 1;
  DepthMaps blind, completed;
  DepthPreparation().prepare(cv::Mat1f(odd.height, odd.width, 0.0F), odd, blind);
  ASSERT_TRUE(DepthCompletion().complete(blind, lookAround(scene), Pose::Identity(), completed));
  EXPECT_GT(completed.depth_m(odd.height - 1, odd.width - 1), 0.0F);
}

TEST(DepthCompletion, RefusesAPoseThatIsNone) {
  const DepthScene scene = cornerWithBalls();
  Pose nowhere = Pose::Identity();
  nowhere.translation().x() = std::numeric_limits<double>::quiet_NaN();
  DepthMaps completed;
  EXPECT_THROW(DepthCompletion().complete(measure(scene, Pose::Identity()), lookAround(scene), nowhere, completed),
               std::invalid_argument);
}

}  // namespace
}  // namespace saccade
