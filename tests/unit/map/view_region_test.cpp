#include "saccade/map/view_region.hpp"

#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace saccade {
namespace {

const PinholeCamera kCamera{640, 480, 500.0, 510.0, 300.0, 250.0};

Eigen::AlignedBox3d boxAround(const Eigen::Vector3d& centre, double edge_m) {
  return {centre - Eigen::Vector3d::Constant(edge_m / 2), centre + Eigen::Vector3d::Constant(edge_m / 2)};
}

Pose somePose(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Pose T_WC = Pose::Identity();
  T_WC.linear() =
      Eigen::Quaterniond(any(random), any(random), any(random), any(random)).normalized().toRotationMatrix();
  T_WC.translation() = 10.0 * Eigen::Vector3d(any(random), any(random), any(random));
  return T_WC;
}

TEST(ViewRegion, TouchesEveryBoxThatHoldsAPointOfTheFrustumOrIsWithinTheMargin) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr double kFarthest_m = 4.0, kMargin_m = 0.25, kEdge_m = 0.3;
  for (int i = 0; i < 20000; ++i) {
    const Pose T_WC = somePose(random);
    const ViewRegion region(kCamera, T_WC, kFarthest_m, kMargin_m);
    const double u = 640.0 * unit(random) - 0.5, v = 480.0 * unit(random) - 0.5;
    const Eigen::Vector3d seen = T_WC * kCamera.unproject(u, v, kFarthest_m * unit(random));
    const Eigen::Vector3d aside = Eigen::Vector3d(unit(random), unit(random), unit(random)).array() - 0.5;
    ASSERT_TRUE(region.touches(boxAround(seen + kEdge_m * aside, kEdge_m)));
    ASSERT_TRUE(region.touches(boxAround(seen + kMargin_m * aside.normalized(), 1e-6)));
  }
}

TEST(ViewRegion, DoesNotTouchWhatLiesBeyondAnySide) {
  std::mt19937 random(2);
  const Pose T_WC = somePose(random);
  const ViewRegion region(kCamera, T_WC, 4.0, 0.1);
  const auto touches = [&](double x, double y, double z) {
    return region.touches(boxAround(T_WC * Eigen::Vector3d(x, y, z), 0.02));
  };
  EXPECT_TRUE(touches(0.0, 0.0, 2.0));
  EXPECT_FALSE(touches(0.0, 0.0, -0.2));
  EXPECT_FALSE(touches(0.0, 0.0, 4.2));
  // At 2 m the image's edges are at x = -1.20 and 1.36 m, y = -0.98 and 0.90 m; the margin makes it 0.12 m more.
  EXPECT_TRUE(touches(-1.2, 0.0, 2.0));
  EXPECT_FALSE(touches(-1.4, 0.0, 2.0));
  EXPECT_TRUE(touches(1.35, 0.0, 2.0));
  EXPECT_FALSE(touches(1.55, 0.0, 2.0));
  EXPECT_FALSE(touches(0.0, -1.2, 2.0));
  EXPECT_FALSE(touches(0.0, 1.1, 2.0));
  EXPECT_EQ(region.eye_W(), T_WC.translation());
}

TEST(ViewRegion, RefusesAPoseThatIsNotFinite) {
  Pose T_WC = Pose::Identity();
  T_WC.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ViewRegion(kCamera, T_WC, 4.0, 0.1), std::invalid_argument);
  EXPECT_THROW(ViewRegion(kCamera, Pose::Identity(), -1.0, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
