#include "saccade/sources/depth_registration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/sources/undistortion.hpp"

namespace saccade {
namespace {

const PinholeCamera kDepth{640, 480, 585.0, 585.0, 320.0, 240.0};
const PinholeCamera kColor{640, 480, 521.0, 523.0, 321.5, 238.5};
// Inverse depth is interpolated in single precision; triangles of a plane are exact otherwise.
constexpr double kPlaneTolerance_m = 5e-5;
// The box's outline is known to the depth camera to one of its pixels, which is 0.9 pixel of the colour camera; a pixel
// is judged only if it is farther than this from the outline.
constexpr double kOutlineMargin_px = 2.0;

Pose sensorPose() {
  Pose T_CD = Pose::Identity();
  T_CD.linear() =
      (Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-0.008, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(0.003, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  T_CD.translation() = Eigen::Vector3d(-0.05, 0.004, 0.002);
  return T_CD;
}

/// A slanted wall behind a slab with a face towards the depth camera, all given in frame D: the depth along a ray.
struct WallAndSlab {
  Eigen::Vector3d wall_normal = Eigen::Vector3d(0.2, 0.1, -1.0).normalized();
  double wall_distance_m = -2.0;  // normal · p
  double slab_z_m = 1.0;
  Eigen::Vector2d slab_low{-0.25, -0.2}, slab_high{0.2, 0.25};

  [[nodiscard]] bool onSlab(const Eigen::Vector3d& p_D) const {
    return p_D.x() >= slab_low.x() && p_D.x() <= slab_high.x() && p_D.y() >= slab_low.y() && p_D.y() <= slab_high.y();
  }

  /// Point met by the ray `origin + t * direction`, t > 0.
  [[nodiscard]] Eigen::Vector3d hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d slab = origin + direction * ((slab_z_m - origin.z()) / direction.z());
    if (onSlab(slab)) return slab;
    return origin + direction * ((wall_distance_m - wall_normal.dot(origin)) / wall_normal.dot(direction));
  }
};

cv::Mat1f renderDepth(const WallAndSlab& scene) {
  cv::Mat1f depth_m(kDepth.height, kDepth.width);
  for (int v = 0; v < kDepth.height; ++v) {
    for (int u = 0; u < kDepth.width; ++u) {
      depth_m(v, u) = static_cast<float>(scene.hit(Eigen::Vector3d::Zero(), kDepth.unproject(u, v, 1.0)).z());
    }
  }
  return depth_m;
}

/// Distance of a colour pixel to the slab's outline, pixels; negative inside.
double distanceToSlab(const WallAndSlab& scene, const Pose& T_CD, double u, double v) {
  const Pose T_DC = T_CD.inverse();
  const Eigen::Vector3d o = T_DC.translation(), d = T_DC.linear() * kColor.unproject(u, v, 1.0);
  const Eigen::Vector3d p = o + d * ((scene.slab_z_m - o.z()) / d.z());
  const double outside = std::max({scene.slab_low.x() - p.x(), p.x() - scene.slab_high.x(), scene.slab_low.y() - p.y(),
                                   p.y() - scene.slab_high.y()});
  return outside / scene.slab_z_m * kColor.fx;
}

TEST(DepthRegistration, GivesTheAnalyticDepthOfAPlaneAndASlabWithoutHolesOrSeeThrough) {
  const WallAndSlab scene;
  const Pose T_CD = sensorPose(), T_DC = T_CD.inverse();
  DepthRegistration registration(kColor, {kDepth, {}, T_CD});
  cv::Mat1f registered;
  registration.render(renderDepth(scene), registered);
  ASSERT_EQ(registered.size(), cv::Size(640, 480));

  int slab_pixels = 0, wall_pixels = 0, shadow_pixels = 0;
  for (int v = 0; v < kColor.height; ++v) {
    for (int u = 0; u < kColor.width; ++u) {
      const double to_slab = distanceToSlab(scene, T_CD, u, v);
      if (std::abs(to_slab) < kOutlineMargin_px) continue;
      const Eigen::Vector3d p_D = scene.hit(T_DC.translation(), T_DC.linear() * kColor.unproject(u, v, 1.0));
      const Eigen::Vector2d seen_at = kDepth.project(p_D);
      const bool seen_by_D = seen_at.x() > 1 && seen_at.y() > 1 && seen_at.x() < 638 && seen_at.y() < 478;
      if (!seen_by_D) continue;
      const double expected = (T_CD * p_D).z();
      if (to_slab < 0) {
        ++slab_pixels;
        ASSERT_NEAR(registered(v, u), expected, kPlaneTolerance_m) << "slab, pixel " << u << ", " << v;
        continue;
      }
      // The wall's point is hidden from D where the ray from D meets the slab on its way.
      const Eigen::Vector3d on_slab = p_D * (scene.slab_z_m / p_D.z());
      const double margin = kOutlineMargin_px / kDepth.fx;
      WallAndSlab wider = scene, narrower = scene;
      wider.slab_low.array() -= margin, wider.slab_high.array() += margin;
      narrower.slab_low.array() += margin, narrower.slab_high.array() -= margin;
      if (narrower.onSlab(on_slab)) {
        ++shadow_pixels;
        ASSERT_EQ(registered(v, u), 0.0f) << "what D cannot see stays empty, pixel " << u << ", " << v;
      } else if (!wider.onSlab(on_slab)) {
        ++wall_pixels;
        ASSERT_NEAR(registered(v, u), expected, kPlaneTolerance_m) << "wall, pixel " << u << ", " << v;
      }
    }
  }
  EXPECT_GT(slab_pixels, 40000);
  EXPECT_GT(wall_pixels, 100000);
  EXPECT_GT(shadow_pixels, 1000) << "the two cameras stand too close together for this test";
}

TEST(DepthRegistration, IsTheIdentityForOneCamera) {
  const WallAndSlab scene;
  const cv::Mat1f depth_m = renderDepth(scene);
  DepthRegistration registration(kDepth, {kDepth, {}, Pose::Identity()});
  cv::Mat1f registered;
  registration.render(depth_m, registered);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) ASSERT_NEAR(registered(v, u), depth_m(v, u), kPlaneTolerance_m) << u << ", " << v;
  }
}

TEST(DepthRegistration, FillsAColourImageOfTwiceTheResolution) {
  const WallAndSlab scene;
  const PinholeCamera fine{1280, 960, 1042, 1042, 640, 480};
  DepthRegistration registration(fine, {kDepth, {}, Pose::Identity()});
  cv::Mat1f registered;
  cv::Mat1f wall(480, 640, 2.0f);
  registration.render(wall, registered);
  for (int v = 100; v < 860; ++v) {
    for (int u = 100; u < 1180; ++u) ASSERT_NEAR(registered(v, u), 2.0f, kPlaneTolerance_m) << u << ", " << v;
  }
}

TEST(DepthRegistration, RemovesTheDistortionOfTheDepthCamera) {
  const LensDistortion lens{-0.2, 0.05, 0.001, -0.001, 0.0};
  DepthRegistration registration(kDepth, {kDepth, lens, Pose::Identity()});
  // A wall at 1 m with a marked region of another depth around one distorted pixel position.
  const auto [x, y] = lens.distort((500 - 320.0) / 585.0, (400 - 240.0) / 585.0);
  const int u = static_cast<int>(std::lround(585 * x + 320)), v = static_cast<int>(std::lround(585 * y + 240));
  ASSERT_GT(std::hypot(u - 500, v - 400), 4.0) << "the lens must move this pixel";
  cv::Mat1f depth_m(480, 640, 2.0f);
  depth_m(cv::Rect(u - 2, v - 2, 5, 5)) = 1.0f;
  cv::Mat1f registered;
  registration.render(depth_m, registered);
  EXPECT_NEAR(registered(400, 500), 1.0f, kPlaneTolerance_m);
  EXPECT_NEAR(registered(v, u), 2.0f, kPlaneTolerance_m);
}

TEST(DepthRegistration, BridgesTheStepsOfQuantisedDepthButNoDiscontinuity) {
  DepthRegistration registration(kDepth, {kDepth, {}, Pose::Identity()});
  cv::Mat1f steps(480, 640);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) steps(v, u) = (u / 7) % 2 == 0 ? 4.0f : 4.04f;  // one Kinect step at 4 m
  }
  cv::Mat1f registered;
  registration.render(steps, registered);
  EXPECT_EQ(cv::countNonZero(registered), 640 * 480);

  cv::Mat1f jump(480, 640, 2.0f);
  jump.colRange(320, 640) = 1.0f;
  Pose shifted = Pose::Identity();
  shifted.translation().x() = 0.1;  // opens a gap of 29 px behind the near half
  DepthRegistration apart(kDepth, {kDepth, {}, shifted});
  apart.render(jump, registered);
  for (int v = 5; v < 475; ++v) {
    for (int u = 5; u < 630; ++u) {
      const float d = registered(v, u);
      ASSERT_TRUE(d == 0.0f || std::abs(d - 1.0f) < 1e-4f || std::abs(d - 2.0f) < 1e-4f) << d;
    }
    ASSERT_EQ(registered(v, 365), 0.0f);
  }
}

TEST(DepthRegistration, TakesNanNegativeAndInfiniteDepthAsUnmeasured) {
  DepthRegistration registration(kColor, {kDepth, {}, sensorPose()});
  cv::Mat1f registered;
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -1.0f, 0.0f, std::numeric_limits<float>::infinity()}) {
    registration.render(cv::Mat1f(480, 640, bad), registered);
    EXPECT_EQ(cv::countNonZero(registered), 0) << bad;
  }
  EXPECT_THROW(registration.render(cv::Mat1f(10, 10, 1.0f), registered), std::invalid_argument);
}

TEST(Undistortion, MovesEveryPointToItsIdealPlace) {
  const PinholeCamera camera{640, 480, 520, 520, 320, 240};
  const LensDistortion lens{-0.2, 0.05, 0.001, 0.002, 0.01};
  const Undistortion undistortion(camera, {camera, lens});
  for (const cv::Point ideal : {cv::Point(100, 80), cv::Point(320, 240), cv::Point(560, 400)}) {
    const auto [x, y] = lens.distort((ideal.x - camera.cx) / camera.fx, (ideal.y - camera.cy) / camera.fy);
    cv::Mat3b distorted(480, 640, cv::Vec3b(0, 0, 0));
    cv::Mat1w distorted_label(480, 640, static_cast<ushort>(0));
    const cv::Rect spot(static_cast<int>(std::lround(camera.fx * x + camera.cx)) - 2,
                        static_cast<int>(std::lround(camera.fy * y + camera.cy)) - 2, 5, 5);
    distorted(spot) = cv::Vec3b(250, 250, 250);
    distorted_label(spot) = static_cast<ushort>(300);
    cv::Mat3b corrected;
    cv::Mat1w corrected_label;
    undistortion.undistort(distorted, corrected);
    undistortion.undistort(distorted_label, corrected_label);
    EXPECT_EQ(corrected(ideal), cv::Vec3b(250, 250, 250)) << ideal;
    EXPECT_EQ(corrected_label(ideal), 300) << ideal;
  }
  cv::Mat3b image(480, 640, cv::Vec3b(1, 2, 3)), copy;
  const Undistortion none(camera, {camera, {}});
  none.undistort(image, copy);
  EXPECT_EQ(cv::norm(image, copy, cv::NORM_INF), 0.0);
  EXPECT_NE(image.data, copy.data);
}

}  // namespace
}  // namespace saccade
