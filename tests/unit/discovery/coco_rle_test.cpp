#include "saccade/discovery/coco_rle.hpp"

#include <algorithm>
#include <random>
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

TEST(CocoRle, RunsGiveTheStringOfTheirMask) {
  std::mt19937 random(7);
  const cv::Size size(23, 17);
  for (int round = 0; round < 50; ++round) {
    cv::Mat1b mask(size, std::uint8_t{0});
    CocoRleWriter writer(size);
    for (int u = 0; u < size.width; ++u) {
      for (int v = 0; v < size.height;) {  // runs that touch each other within and across columns, and gaps
        const int end = std::min<int>(size.height, v + 1 + static_cast<int>(random() % 9));
        if (random() % 2 == 0) {
          writer.addRun(u, v, end);
          mask(cv::Range(v, end), cv::Range(u, u + 1)).setTo(1);
        }
        v = end;
      }
    }
    EXPECT_EQ(writer.finish(), encodeCocoRle(mask));
  }
}

TEST(CocoRle, RefusesGarbage) {
  EXPECT_THROW((void)decodeCocoRle("61X1", {9, 10}), std::invalid_argument);           // too short
  EXPECT_THROW((void)decodeCocoRle("61X13mN000`00", {9, 10}), std::invalid_argument);  // too long
  EXPECT_THROW((void)decodeCocoRle("61X13mN000`", {9, 10}), std::invalid_argument);    // cut
  EXPECT_THROW((void)decodeCocoRle("6 ~", {9, 10}), std::invalid_argument);
  EXPECT_THROW((void)decodeCocoRle("ooooooooooooooooooooo", {9, 10}), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
