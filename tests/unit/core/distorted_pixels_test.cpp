#include "saccade/core/distorted_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/sources/undistortion.hpp"

namespace saccade {
namespace {

const PinholeCamera kCamera{160, 120, 130.0, 131.0, 79.0, 60.5};
const LensDistortion kLens{-0.2, 0.05, 0.001, -0.002, 0.01};
const DistortedCamera kReal{kCamera, kLens};

TEST(LensDistortion, UndistortIsTheInverseOfDistort) {
  constexpr double kTolerance = 1e-6;  // as documented; 1e-3 px at 1000 px focal length
  for (double x = -0.6; x <= 0.6; x += 0.1) {
    for (double y = -0.45; y <= 0.45; y += 0.15) {
      const auto [u, v] = kLens.distort(x, y);
      const auto [back_x, back_y] = kLens.undistort(u, v);
      EXPECT_NEAR(back_x, x, kTolerance);
      EXPECT_NEAR(back_y, y, kTolerance);
    }
  }
}

TEST(DistortedPixels, TakesBackWhatUndistortionRemoved) {
  // A label of broad squares, so that rounding to pixels moves edges only.
  cv::Mat1w seen(kCamera.height, kCamera.width);
  for (int v = 0; v < seen.rows; ++v) {
    for (int u = 0; u < seen.cols; ++u) seen(v, u) = static_cast<std::uint16_t>(1 + u / 40 + 4 * (v / 40));
  }
  cv::Mat1w ideal, back;
  Undistortion(kCamera, kReal).undistort(seen, ideal);
  EXPECT_GT(cv::countNonZero(ideal != seen), seen.total() / 50);  // the lens does something
  DistortedPixels(kCamera, kReal).distort(ideal, back, std::uint16_t{0});
  int wrong = 0;
  for (int v = 0; v < seen.rows; ++v) {
    for (int u = 0; u < seen.cols; ++u) {
      const bool on_edge = u % 40 < 2 || u % 40 > 37 || v % 40 < 2 || v % 40 > 37;
      if (!on_edge && back(v, u) != 0 && back(v, u) != seen(v, u)) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0);
  // A barrel lens sees more than the ideal image of the same focal length holds: here 13 % of its pixels.
  EXPECT_GT(cv::countNonZero(back), seen.total() * 85 / 100);
}

TEST(IdealCamera, ShowsEveryPixelOfABarrelLens) {
  const PinholeCamera ideal = idealCameraOf(kReal);
  EXPECT_LT(ideal.fx, kCamera.fx);
  EXPECT_DOUBLE_EQ(ideal.fx / ideal.fy, kCamera.fx / kCamera.fy);
  const cv::Mat1b all(kCamera.height, kCamera.width, std::uint8_t{1});
  cv::Mat1b back;
  DistortedPixels(ideal, kReal).distort(all, back, std::uint8_t{0});
  EXPECT_EQ(cv::countNonZero(back), kCamera.width * kCamera.height);
  // No wider than needed: along one axis the outermost rays lie on the two borders.
  double low_u = 1e9, high_u = -1e9, low_v = 1e9, high_v = -1e9;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const auto [x, y] = kLens.undistort((u - kCamera.cx) / kCamera.fx, (v - kCamera.cy) / kCamera.fy);
      low_u = std::min(low_u, ideal.fx * x + ideal.cx);
      high_u = std::max(high_u, ideal.fx * x + ideal.cx);
      low_v = std::min(low_v, ideal.fy * y + ideal.cy);
      high_v = std::max(high_v, ideal.fy * y + ideal.cy);
    }
  }
  const double tolerance = 1e-6;  // rounding
  EXPECT_NEAR(std::max(high_u - low_u - (kCamera.width - 1), high_v - low_v - (kCamera.height - 1)), 0.0, tolerance);
}

TEST(IdealCamera, IsTheCameraItselfWhereNothingWouldBeLost) {
  EXPECT_EQ(idealCameraOf({kCamera, {}}), kCamera);
  const PinholeCamera centred{160, 120, 130.0, 130.0, 79.5, 59.5};
  const LensDistortion pincushion{0.1, 0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(idealCameraOf({centred, pincushion}), centred);
  EXPECT_THROW((void)idealCameraOf({}), std::invalid_argument);
}

TEST(DistortedPixels, WithoutDistortionCopies) {
  const DistortedPixels pixels(kCamera);
  EXPECT_TRUE(pixels.areIdeal());
  const cv::Mat1i image(kCamera.height, kCamera.width, 7);
  cv::Mat1i copy;
  pixels.distort(image, copy, -1);
  EXPECT_EQ(cv::countNonZero(copy != image), 0);
  EXPECT_NE(copy.data, image.data);
}

TEST(DistortedPixels, RefusesEmptyCamerasAndImagesOfAnotherSize) {
  EXPECT_THROW(DistortedPixels({}, kReal), std::invalid_argument);
  cv::Mat1i out;
  EXPECT_THROW(DistortedPixels(kCamera, kReal).distort(cv::Mat1i(4, 4, 1), out, 0), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
