#include "saccade/discovery/box_agreement.hpp"

#include <random>

#include <gtest/gtest.h>

#include "saccade/discovery/ranker.hpp"

namespace saccade {
namespace {

constexpr double kLeastIou = 0.7;  // as box_agreement.hpp says

Candidate withBox(const cv::Rect& box, int unions) {
  Candidate candidate;
  candidate.box = box;
  candidate.unions = unions;
  return candidate;
}

TEST(BoxAgreement, CountsTheUnionsOfEveryBoxThatOverlapsEnough) {
  std::mt19937 random(3);
  Candidates pool;
  for (int i = 0; i < 400; ++i) {
    const auto below = [&](unsigned n) { return static_cast<int>(random() % n); };
    pool.push_back(withBox({below(60), below(40), 20 + below(30), 20 + below(30)}, 1 + below(4)));
  }
  const std::vector<int> agreeing = countAgreeing(pool);
  int agreements = 0;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    int expected = 0;
    for (const Candidate& other : pool) {
      if (boxIou(pool[i].box, other.box) >= kLeastIou) expected += other.unions;
    }
    EXPECT_EQ(agreeing[i], expected) << pool[i].box;
    agreements += expected - pool[i].unions;
  }
  EXPECT_GT(agreements, 400) << "boxes too sparse to test anything";
}

TEST(BoxAgreement, TakesInTheBoxThatOverlapsByExactlyTheLimit) {
  // 70 of 100 columns: intersection over union 7/10.
  const Candidates pool{withBox({0, 0, 100, 10}, 1), withBox({0, 0, 70, 10}, 2), withBox({0, 0, 69, 10}, 5)};
  EXPECT_EQ(countAgreeing(pool), (std::vector<int>{3, 8, 7}));
}

TEST(BoxAgreement, OfAnEmptyPoolIsEmpty) {
  EXPECT_TRUE(countAgreeing({}).empty());
}

}  // namespace
}  // namespace saccade
