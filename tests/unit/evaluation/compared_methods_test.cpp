#include "saccade/evaluation/compared_methods.hpp"

#include <gtest/gtest.h>

namespace saccade {
namespace {

/// Tiles of many colours before a grey wall, each an object.
RgbdFrame tiles() {
  RgbdFrame frame;
  frame.color = cv::Mat3b(240, 320, cv::Vec3b(110, 110, 110));
  frame.label = cv::Mat1w(240, 320, std::uint16_t{0});
  for (int i = 0; i < 12; ++i) {
    const cv::Rect tile(20 + 75 * (i % 4), 15 + 75 * (i / 4), 50, 50);
    frame.color(tile).setTo(cv::Vec3b(static_cast<std::uint8_t>(20 * i), static_cast<std::uint8_t>(250 - 20 * i), 40));
    frame.label(tile).setTo(1 + i);
  }
  return frame;
}

TEST(ComparedMethods, JudgesRivalsByAsManyBoxesAsOursToo) {
  const RgbdFrame frame = tiles();
  ComparisonOptions options;
  options.rivals = true;
  constexpr int kOurs = 7;
  ComparedMethods compared(options, {}, {}, {});
  compared.add(frame, {}, {}, kOurs);
  const std::vector<MethodScore> scores = compared.finish();
  ASSERT_EQ(scores.size(), 2U);
  double best = 0.0;
  for (const MethodScore& rival : scores) {
    ASSERT_GT(rival.candidates, kOurs) << rival.name;
    ASSERT_TRUE(rival.boxes_as_many_as_ours) << rival.name;
    for (const int k : {1, kOurs, 255}) {
      EXPECT_EQ(rival.boxes_as_many_as_ours->recall(k), rival.boxes.recall(std::min(k, kOurs))) << rival.name;
      EXPECT_EQ(rival.boxes_as_many_as_ours->precision(k), rival.boxes.precision(std::min(k, kOurs))) << rival.name;
    }
    best = std::max(best, rival.boxes.recall(255));
  }
  EXPECT_GT(best, 0.0) << "nothing found, nothing compared";
}

}  // namespace
}  // namespace saccade
