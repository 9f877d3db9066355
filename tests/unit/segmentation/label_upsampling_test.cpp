#include "segmentation/label_upsampling.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

namespace saccade {
namespace {

cv::Mat3b noise(cv::Size size, std::uint64_t seed) {
  cv::Mat3b image(size);
  cv::RNG(seed).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

cv::Vec3b meanOf(const cv::Mat3b& image, int y, int x) {
  cv::Vec3b mean;
  for (int c = 0; c < 3; ++c) {
    int sum = 0;
    for (const cv::Point d : {cv::Point(0, 0), cv::Point(1, 0), cv::Point(0, 1), cv::Point(1, 1)}) {
      sum += image(std::min(2 * y + d.y, image.rows - 1), std::min(2 * x + d.x, image.cols - 1))[c];
    }
    mean[c] = static_cast<std::uint8_t>((sum + 2) / 4);
  }
  return mean;
}

int difference(const cv::Vec3b& a, const cv::Vec3b& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

/// Pixel by pixel, as the class says.
Segmentation upsampledOneByOne(const Segmentation& half, const cv::Mat3b& half_image, const cv::Mat3b& image) {
  Segmentation result{cv::Mat1i(image.size()), 0};
  std::map<int, int> numbers;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const int own_y = y / 2, own_x = x / 2;
      const int next_y = std::clamp(y % 2 == 0 ? own_y - 1 : own_y + 1, 0, half_image.rows - 1);
      const int next_x = std::clamp(x % 2 == 0 ? own_x - 1 : own_x + 1, 0, half_image.cols - 1);
      cv::Point best(own_x, own_y);
      for (const cv::Point q : {cv::Point(next_x, own_y), cv::Point(own_x, next_y), cv::Point(next_x, next_y)}) {
        if (difference(image(y, x), half_image(q)) < difference(image(y, x), half_image(best))) best = q;
      }
      result.labels(y, x) = numbers.try_emplace(half.labels(best), static_cast<int>(numbers.size())).first->second;
    }
  }
  result.count = static_cast<int>(numbers.size());
  return result;
}

const cv::Size kSizes[] = {{1, 1}, {2, 1}, {1, 2}, {5, 3}, {64, 32}, {65, 33}, {97, 61}, {130, 40}};

TEST(LabelUpsampling, HalvesToTheMeansOfTwoByTwoPixels) {
  for (const cv::Size size : kSizes) {
    const cv::Mat3b image = noise(size, 1);
    LabelUpsampler upsampler;
    const cv::Mat3b& half = upsampler.halve(image);
    ASSERT_EQ(half.size(), cv::Size((size.width + 1) / 2, (size.height + 1) / 2));
    for (int y = 0; y < half.rows; ++y) {
      for (int x = 0; x < half.cols; ++x) EXPECT_EQ(half(y, x), meanOf(image, y, x)) << size << " " << x << " " << y;
    }
  }
}

TEST(LabelUpsampling, GivesThePixelsWhatTheyTakeOneByOne) {
  LabelUpsampler upsampler;
  for (const cv::Size size : kSizes) {
    const cv::Mat3b image = noise(size, 2);
    const cv::Mat3b& half_image = upsampler.halve(image);
    Segmentation half{cv::Mat1i(half_image.size()), 3};
    cv::RNG(3).fill(half.labels, cv::RNG::UNIFORM, 0, half.count);
    Segmentation found;
    upsampler.upsample(half, image, found);
    const Segmentation expected = upsampledOneByOne(half, half_image, image);
    EXPECT_EQ(found.count, expected.count) << size;
    EXPECT_EQ(cv::norm(found.labels, expected.labels, cv::NORM_INF), 0.0) << size;
  }
}

TEST(LabelUpsampling, FitsTheOutlineOfAThingToTheWholeImage) {
  // From odd to odd: the pixels of the half along the outline are mixed, and labelled with the thing.
  const cv::Rect thing(5, 7, 21, 13);
  cv::Mat3b image(40, 50, cv::Vec3b(40, 60, 50));
  image(thing) = cv::Vec3b(200, 180, 220);
  LabelUpsampler upsampler;
  Segmentation half{cv::Mat1i(upsampler.halve(image).size(), 0), 2};
  half.labels(cv::Rect(2, 3, 11, 7)) = 1;
  Segmentation found;
  upsampler.upsample(half, image, found);
  cv::Mat1i expected(image.size(), 0);
  expected(thing) = 1;
  EXPECT_EQ(cv::norm(found.labels, expected, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace saccade
