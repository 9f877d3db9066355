#include "saccade/evaluation/discovery_metrics.hpp"

#include <random>

#include <gtest/gtest.h>

#include "saccade/discovery/coco_rle.hpp"

namespace saccade {
namespace {

constexpr int kIgnoreFrom = 100;

DiscoveryRules rules() {
  DiscoveryRules r;
  r.ignore_from = kIgnoreFrom;
  return r;
}

/// Objects 1 (20 x 20 at 10, 10), 2 (30 x 10 at 50, 40), 3 (10 x 10: under 200 px), ignored 100 (40 x 40 at 100, 20).
cv::Mat1w label() {
  cv::Mat1w image(120, 160, std::uint16_t{0});
  image(cv::Rect(10, 10, 20, 20)) = 1;
  image(cv::Rect(50, 40, 30, 10)) = 2;
  image(cv::Rect(5, 100, 10, 10)) = 3;
  image(cv::Rect(100, 20, 40, 40)) = 100;
  return image;
}

std::string maskOf(const cv::Rect& box, cv::Size size) {
  cv::Mat1b mask(size, std::uint8_t{0});
  mask(box) = 255;
  return encodeCocoRle(mask);
}

std::vector<std::string> masksOf(const std::vector<cv::Rect>& boxes) {
  std::vector<std::string> masks;
  for (const cv::Rect& box : boxes) masks.push_back(maskOf(box, {160, 120}));
  return masks;
}

TEST(LabelledObjects, LeavesOutIgnoredIdsAndObjectsUnder200Pixels) {
  const auto objects = labelledObjects(label(), rules());
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[0].id, 1);
  EXPECT_EQ(objects[0].area, 400);
  EXPECT_EQ(objects[0].box, cv::Rect(10, 10, 20, 20));
  EXPECT_EQ(objects[1].box, cv::Rect(50, 40, 30, 10));
}

TEST(MatchBoxes, FindsAnObjectAtTheFirstCandidateAboveHalfOverlap) {
  // Half of the box of object 1 exactly (not above), all of it, and something that is nowhere.
  const FrameMatches matches =
      matchBoxes(std::vector<cv::Rect>{{10, 10, 20, 10}, {10, 10, 20, 20}, {60, 90, 9, 9}}, label(), rules());
  EXPECT_EQ(matches.found_at, (std::vector<int>{1, FrameMatches::kNever}));
  EXPECT_EQ(matches.is_right, (std::vector<char>{0, 1, 0}));
  EXPECT_EQ(matches.is_ignored, (std::vector<char>{0, 0, 0}));
  EXPECT_DOUBLE_EQ(matches.best_overlap[0], 1.0);
  EXPECT_DOUBLE_EQ(matches.best_overlap[1], 0.0);
}

TEST(MatchBoxes, ACandidateMostlyOnIgnoredPixelsCountsNeitherWay) {
  const std::vector<cv::Rect> boxes = {{100, 20, 40, 40}, {90, 20, 19, 40}, {90, 20, 21, 40}};
  const FrameMatches matches = matchBoxes(boxes, label(), rules());
  EXPECT_EQ(matches.is_ignored, (std::vector<char>{1, 0, 1}));  // all, 9 of 19 columns, 11 of 21 columns
  DiscoveryScore score;
  score.add(matches);
  EXPECT_DOUBLE_EQ(score.precision(3), 0.0);  // one that counts, and it is wrong
}

TEST(MatchBoxes, LooksAtTheFirst255Only) {
  std::vector<cv::Rect> boxes(255, cv::Rect(140, 100, 5, 5));
  boxes.push_back({10, 10, 20, 20});
  EXPECT_EQ(matchBoxes(boxes, label(), rules()).found_at[0], FrameMatches::kNever);
}

TEST(MatchMasks, EqualsPixelByPixelCountingOnRandomMasks) {
  std::mt19937 random(3);
  const cv::Mat1w truth = label();
  const auto objects = labelledObjects(truth, rules());
  for (int round = 0; round < 50; ++round) {
    std::vector<cv::Rect> boxes;
    std::vector<double> best(objects.size(), 0.0);
    for (int i = 0; i < 10; ++i) {
      const int u = static_cast<int>(random() % 120), v = static_cast<int>(random() % 90);
      boxes.emplace_back(u, v, 1 + static_cast<int>(random() % 40), 1 + static_cast<int>(random() % 30));
      for (std::size_t j = 0; j < objects.size(); ++j) {
        int shared = 0;
        for (int y = v; y < v + boxes.back().height; ++y) {
          for (int x = u; x < u + boxes.back().width; ++x) shared += truth(y, x) == objects[j].id ? 1 : 0;
        }
        best[j] = std::max(best[j], double(shared) / (boxes.back().area() + objects[j].area - shared));
      }
    }
    const FrameMatches matches = matchMasks(masksOf(boxes), truth, rules());
    for (std::size_t j = 0; j < objects.size(); ++j) {
      EXPECT_DOUBLE_EQ(matches.best_overlap[j], best[j]);
      EXPECT_EQ(matches.found_at[j] != FrameMatches::kNever, best[j] > 0.5);
    }
  }
}

TEST(MatchMasks, RefusesAMaskOfAnotherImage) {
  EXPECT_THROW((void)matchMasks({maskOf({0, 0, 3, 3}, {20, 10})}, label(), rules()), std::invalid_argument);
}

TEST(DiscoveryScore, GivesTheMeansThatAreDefinedOverFrames) {
  const cv::Mat1w both = label(), none(120, 160, std::uint16_t{0});
  const std::vector<cv::Rect> first = {{10, 10, 20, 20}, {0, 0, 9, 9}, {50, 40, 30, 10}, {0, 50, 9, 9}};
  DiscoveryScore score;
  score.add(matchBoxes(first, both, rules()));                                    // finds 1 at rank 0, 2 at rank 2
  score.add(matchBoxes(std::vector<cv::Rect>{{50, 40, 30, 10}}, both, rules()));  // finds 2 only
  score.add(matchBoxes(std::vector<cv::Rect>{{50, 40, 30, 10}}, none, rules()));  // no object in view: no recall
  EXPECT_EQ(score.frames(), 2);
  EXPECT_DOUBLE_EQ(score.recall(1), (0.5 + 0.5) / 2);
  EXPECT_DOUBLE_EQ(score.recall(3), (1.0 + 0.5) / 2);
  EXPECT_DOUBLE_EQ(score.precision(2), (0.5 + 1.0 + 0.0) / 3);
  EXPECT_DOUBLE_EQ(score.precision(4), (0.5 + 1.0 + 0.0) / 3);
  EXPECT_DOUBLE_EQ(score.fScore(4), 2 * 0.5 * 0.75 / (0.5 + 0.75));
  EXPECT_DOUBLE_EQ(score.recallAuc(), (2 * 0.5 + 253 * 0.75) / 255);
  EXPECT_DOUBLE_EQ(score.meanBestOverlap(), (1.0 + 0.5) / 2);
}

TEST(DiscoveryScore, GlobalRecallNeverFallsAndIsOfTheWholeSequencesObjects) {
  cv::Mat1w one = label();
  one.setTo(0, one == 2);
  DiscoveryScore score;
  score.add(matchBoxes(std::vector<cv::Rect>{{10, 10, 20, 20}}, one, rules()));
  score.add(matchBoxes(std::vector<cv::Rect>{}, label(), rules()));
  score.add(matchBoxes(std::vector<cv::Rect>{{0, 0, 5, 5}, {50, 40, 30, 10}}, label(), rules()));
  EXPECT_EQ(score.globalRecallOverTime(1), (std::vector<double>{0.5, 0.5, 0.5}));
  EXPECT_EQ(score.globalRecallOverTime(2), (std::vector<double>{0.5, 0.5, 1.0}));
  EXPECT_DOUBLE_EQ(score.globalRecall(2), 1.0);
}

TEST(DiscoveryScore, OfNothingIsZero) {
  const DiscoveryScore score;
  EXPECT_EQ(score.recall(20), 0.0);
  EXPECT_EQ(score.precision(20), 0.0);
  EXPECT_EQ(score.fScore(20), 0.0);
  EXPECT_EQ(score.globalRecall(20), 0.0);
  EXPECT_EQ(score.meanBestOverlap(), 0.0);
}

}  // namespace
}  // namespace saccade
