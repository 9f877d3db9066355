#include "saccade/tracking/intensity_pyramid.hpp"

#include <gtest/gtest.h>

namespace saccade {
namespace {

// Grey values are rounded to whole ones before they are averaged.
constexpr float kRounding = 0.5F;

TEST(IntensityPyramid, HoldsTheMeansOfItsPixels) {
  // A ramp: the mean over a block is the value at its centre.
  cv::Mat3b ramp(48, 64);
  for (int v = 0; v < ramp.rows; ++v) {
    for (int u = 0; u < ramp.cols; ++u) ramp(v, u) = cv::Vec3b::all(static_cast<unsigned char>(2 * u + v));
  }
  const PinholeCamera camera{64, 48, 60.0, 62.0, 31.5, 23.5};
  IntensityPyramid pyramid;
  pyramid.build(ramp, camera);
  for (std::size_t level = 0; level < IntensityPyramid::kLevels; ++level) {
    const int factor = 2 << level;
    const cv::Mat1f& grey = pyramid.levels[level].grey;
    ASSERT_EQ(grey.size(), cv::Size(64 / factor, 48 / factor));
    EXPECT_EQ(pyramid.levels[level].camera, camera.reducedBy(factor));
    for (int v = 0; v < grey.rows; ++v) {
      for (int u = 0; u < grey.cols; ++u) {
        const double centre_u = factor * u + 0.5 * (factor - 1), centre_v = factor * v + 0.5 * (factor - 1);
        EXPECT_NEAR(grey(v, u), static_cast<float>(2.0 * centre_u + centre_v), kRounding);
      }
    }
  }
}

TEST(IntensityPyramid, WeighsGreenMostAndBlueLeast) {
  const PinholeCamera camera{8, 8, 8.0, 8.0, 3.5, 3.5};
  float greys[3];
  for (int channel = 0; channel < 3; ++channel) {
    cv::Vec3b only(0, 0, 0);
    only[channel] = 200;
    IntensityPyramid pyramid;
    pyramid.build(cv::Mat3b(8, 8, only), camera);
    greys[channel] = pyramid.levels[1].grey(0, 0);
  }
  EXPECT_LT(greys[0], greys[2]);
  EXPECT_LT(greys[2], greys[1]);
  EXPECT_NEAR(greys[0] + greys[1] + greys[2], 200.0F, 3 * kRounding);
}

TEST(IntensityPyramid, LeavesOutAnOddLastRowAndColumn) {
  cv::Mat3b color(7, 9, cv::Vec3b::all(10));
  color.col(8).setTo(cv::Scalar::all(255));
  color.row(6).setTo(cv::Scalar::all(255));
  IntensityPyramid pyramid;
  pyramid.build(color, PinholeCamera{9, 7, 9.0, 9.0, 4.0, 3.0});
  ASSERT_EQ(pyramid.levels[0].grey.size(), cv::Size(4, 3));
  EXPECT_EQ(cv::countNonZero(pyramid.levels[0].grey != 10.0F), 0);
}

}  // namespace
}  // namespace saccade
