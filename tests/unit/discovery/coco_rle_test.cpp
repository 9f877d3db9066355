#include "saccade/discovery/coco_rle.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "support/random_scene.hpp"

namespace saccade {
namespace {

cv::Mat1b maskOfRuns(cv::Size size, const std::vector<int>& runs) {
  cv::Mat1b mask(size, std::uint8_t{0});
  int at = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (int k = 0; k < runs[i]; ++k, ++at) mask(at % size.height, at / size.height) = i % 2 == 1 ? 255 : 0;
  }
  return mask;
}

TEST(CocoRle, WritesTheStringOfTheCocoApi) {
  // Runs 6 1 40 4 5 4 5 4 21, encoded by hand with the rule of rleToString.
  EXPECT_EQ(encodeCocoRle(maskOfRuns({9, 10}, {6, 1, 40, 4, 5, 4, 5, 4, 21})), "61X13mN000`0");
  EXPECT_EQ(encodeCocoRle(cv::Mat1b(2, 3, std::uint8_t{0})), "6");
  EXPECT_EQ(encodeCocoRle(cv::Mat1b(2, 3, std::uint8_t{1})), "06");
}

TEST(CocoRle, DecodingAnEncodedMaskGivesItBack) {
  cv::RNG random(4);
  for (int round = 0; round < 100; ++round) {
    cv::Mat1b mask(random.uniform(1, 40), random.uniform(1, 40));
    random.fill(mask, cv::RNG::UNIFORM, 0, round % 5 + 2);
    mask = mask > round % 3;
    const cv::Mat1b back = decodeCocoRle(encodeCocoRle(mask), mask.size());
    EXPECT_EQ(cv::countNonZero(back != mask), 0);
  }
}

TEST(CocoRle, APartGivesTheStringOfTheWholeImage) {
  cv::RNG random(6);
  for (int round = 0; round < 200; ++round) {
    const cv::Size size(random.uniform(1, 12), random.uniform(1, 12));
    const cv::Point corner(random.uniform(0, size.width), random.uniform(0, size.height));
    const cv::Rect box(
        corner, cv::Size(random.uniform(1, size.width - corner.x + 1), random.uniform(1, size.height - corner.y + 1)));
    cv::Mat1b mask(size, std::uint8_t{0});
    cv::Mat1b part = mask(box);
    random.fill(part, cv::RNG::UNIFORM, 0, 3);
    part = part > 0;
    mask(box) = part;
    EXPECT_EQ(encodeCocoRle(part, corner, size), encodeCocoRle(mask));
  }
}

TEST(CocoRle, RefusesGarbage) {
  EXPECT_THROW((void)decodeCocoRle("61X1", {9, 10}), std::invalid_argument);           // too short
  EXPECT_THROW((void)decodeCocoRle("61X13mN000`00", {9, 10}), std::invalid_argument);  // too long
  EXPECT_THROW((void)decodeCocoRle("61X13mN000`", {9, 10}), std::invalid_argument);    // cut
  EXPECT_THROW((void)decodeCocoRle("6 ~", {9, 10}), std::invalid_argument);
  EXPECT_THROW((void)decodeCocoRle("ooooooooooooooooooooo", {9, 10}), std::invalid_argument);
  EXPECT_THROW((void)encodeCocoRle(cv::Mat1b(3, 3), {8, 8}, {9, 10}), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
