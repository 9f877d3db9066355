#include "map/ray_bounds.hpp"

#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace saccade {
namespace {

constexpr float kSample_m = 0.01F, kMaxRange_m = 4.0F;
constexpr std::uint64_t kAllBlocks = ~std::uint64_t{0};

/// A frame's camera with a quarter of its resolution, of odd size.
PinholeCamera camera() {
  return {159, 121, 131.0, 130.0, 79.0, 61.0};
}

/// Frames the image by a strip of pixels, and adds single ones inside.
cv::Mat1b wantedPixels(int strip) {
  cv::Mat1b wanted(camera().height, camera().width, std::uint8_t{1});
  wanted(cv::Rect(strip, strip, wanted.cols - 2 * strip, wanted.rows - 2 * strip)).setTo(0);
  wanted(40, 51) = wanted(77, 100) = 1;
  return wanted;
}

Eigen::Matrix3f turned(float angle) {
  return Eigen::AngleAxisf(angle, Eigen::Vector3f(0.3F, -0.8F, 0.5F).normalized()).toRotationMatrix();
}

/// Centres of bricks all over the view, also at the camera, behind it and beside the image.
std::vector<Eigen::Vector3f> brickCentres() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> side(-1.5F, 1.5F), depth(-0.1F, 4.1F);
  std::vector<Eigen::Vector3f> centres(400);
  for (Eigen::Vector3f& centre : centres) {
    centre.z() = depth(random);
    centre.x() = side(random) * centre.z();
    centre.y() = side(random) * centre.z();
  }
  return centres;
}

/// Brick by brick, lest the bounds of one hide what another one lacks.
TEST(RayBounds, AreTheSameForWantedPixelsWhenLimitedToThem) {
  int left_out = 0;
  for (const int strip : {0, 1, 9}) {
    const cv::Mat1b wanted = wantedPixels(strip);
    for (const float angle : {0.0F, 0.4F, 2.0F}) {
      RayBounds all, limited;
      for (const Eigen::Vector3f& centre : brickCentres()) {
        all.reset(camera(), turned(angle), kSample_m, kMaxRange_m);
        limited.reset(camera(), turned(angle), kSample_m, kMaxRange_m);
        limited.limitTo(wanted);
        all.add(centre, kAllBlocks);
        limited.add(centre, kAllBlocks);
        for (int v = 0; v < wanted.rows; ++v) {
          for (int u = 0; u < wanted.cols; ++u) {
            const int cell = u / RayBounds::kCellPixels;
            const bool is_same =
                all.nearest(v)[cell] == limited.nearest(v)[cell] && all.slices(v)[cell] == limited.slices(v)[cell];
            if (wanted(v, u) != 0) {
              ASSERT_TRUE(is_same) << u << ", " << v << " of the brick at " << centre.transpose();
            }
            left_out += is_same ? 0 : 1;
          }
        }
      }
    }
  }
  EXPECT_GT(left_out, 10000);
}

TEST(RayBounds, AreNoLongerLimitedAfterAReset) {
  const Eigen::Vector3f centre(0.0F, 0.0F, 1.0F);
  RayBounds bounds;
  bounds.reset(camera(), turned(0.0F), kSample_m, kMaxRange_m);
  bounds.limitTo(cv::Mat1b(camera().height, camera().width, std::uint8_t{0}));
  bounds.add(centre, kAllBlocks);
  EXPECT_EQ(bounds.slices(61)[79 / RayBounds::kCellPixels], 0);
  bounds.reset(camera(), turned(0.0F), kSample_m, kMaxRange_m);
  bounds.add(centre, kAllBlocks);
  EXPECT_NE(bounds.slices(61)[79 / RayBounds::kCellPixels], 0);
}

}  // namespace
}  // namespace saccade
