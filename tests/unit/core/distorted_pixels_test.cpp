#include "saccade/core/distorted_pixels.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/sources/undistortion.hpp"

namespace saccade {
namespace {

const PinholeCamera kCamera{160, 120, 130.0, 131.0, 79.0, 60.5};
const LensDistortion kLens{-0.2, 0.05, 0.001, -0.002, 0.01};

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
  Undistortion(kCamera, kLens).undistort(seen, ideal);
  EXPECT_GT(cv::countNonZero(ideal != seen), seen.total() / 50);  // the lens does something
  DistortedPixels(kCamera, kLens).distort(ideal, back, std::uint16_t{0});
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

TEST(DistortedPixels, WithoutDistortionCopies) {
  const DistortedPixels pixels(kCamera, {});
  EXPECT_TRUE(pixels.areIdeal());
  const cv::Mat1i image(kCamera.height, kCamera.width, 7);
  cv::Mat1i copy;
  pixels.distort(image, copy, -1);
  EXPECT_EQ(cv::countNonZero(copy != image), 0);
  EXPECT_NE(copy.data, image.data);
}

TEST(DistortedPixels, RefusesEmptyCamerasAndImagesOfAnotherSize) {
  EXPECT_THROW(DistortedPixels({}, kLens), std::invalid_argument);
  cv::Mat1i out;
  EXPECT_THROW(DistortedPixels(kCamera, kLens).distort(cv::Mat1i(4, 4, 1), out, 0), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
