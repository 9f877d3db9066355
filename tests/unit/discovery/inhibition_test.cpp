#include "saccade/discovery/inhibition.hpp"

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/proposals.hpp"
#include "support/random_scene.hpp"

namespace saccade {
namespace {

/// A frame, its pool of candidates, and an image that is white in discs here and there.
struct Frame {
  test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  Candidates pool = proposeCandidates(scene.seen, {});
  cv::Mat1b white{scene.seen.imageSize(), std::uint8_t{0}};

  Frame() {
    cv::circle(white, {40, 30}, 28, 255, cv::FILLED);
    cv::circle(white, {130, 90}, 35, 1, cv::FILLED);  // whatever is not 0 is white
  }
};

/// By definition: the white ones among the pixels of the candidate's mask.
double shareByMask(const Candidate& candidate, const Perception& seen, const cv::Mat1b& white) {
  cv::Mat1b mask;
  drawMask(candidate, seen, mask);
  return static_cast<double>(cv::countNonZero(mask & (white != 0))) / cv::countNonZero(mask);
}

TEST(Inhibition, SplitsThePoolByTheWhiteShareOfEachMaskAndKeepsItsOrder) {
  const Frame frame;
  InhibitionConfig config;
  config.theta = 0.4;
  const InhibitionSplit split = withoutInhibited(frame.pool, frame.scene.seen, frame.white, config);
  ASSERT_FALSE(split.open.empty());
  ASSERT_FALSE(split.inhibited.empty());
  ASSERT_EQ(split.open.size() + split.inhibited.size(), frame.pool.size());
  auto open = split.open.begin(), inhibited = split.inhibited.begin();
  for (const Candidate& candidate : frame.pool) {
    const double share = shareByMask(candidate, frame.scene.seen, frame.white);
    const Candidate& found = share >= config.theta ? *inhibited++ : *open++;
    ASSERT_EQ(found.segments, candidate.segments);
    EXPECT_EQ(found.inhibited, share >= config.theta);
    EXPECT_DOUBLE_EQ(found.inhibited_share, share);
  }
}

TEST(Inhibition, SwitchedOffTellsTheSharesAndInhibitsNothing) {
  const Frame frame;
  InhibitionConfig config;
  config.enabled = false;
  const InhibitionSplit split = withoutInhibited(frame.pool, frame.scene.seen, frame.white, config);
  EXPECT_TRUE(split.inhibited.empty());
  ASSERT_EQ(split.open.size(), frame.pool.size());
  EXPECT_TRUE(
      std::any_of(split.open.begin(), split.open.end(), [](const Candidate& c) { return c.inhibited_share > 0.5; }));
}

TEST(Inhibition, NotesHowMuchOfEachCandidateIsFamiliar) {
  Frame frame;
  noteFamiliar(frame.pool, frame.scene.seen, frame.white);
  double most = 0.0;
  for (const Candidate& candidate : frame.pool) {
    EXPECT_DOUBLE_EQ(candidate.familiar_share, shareByMask(candidate, frame.scene.seen, frame.white));
    most = std::max(most, candidate.familiar_share);
  }
  EXPECT_GT(most, 0.5);
}

TEST(Inhibition, WithoutAMapAllIsOpenAndNew) {
  Frame frame;
  EXPECT_EQ(withoutInhibited(frame.pool, frame.scene.seen, {}).open.size(), frame.pool.size());
  noteFamiliar(frame.pool, frame.scene.seen, {});
  for (const Candidate& candidate : frame.pool) EXPECT_EQ(candidate.familiar_share, 0.0);
}

TEST(Inhibition, RefusesAnImageOfAnotherSize) {
  Frame frame;
  const cv::Mat1b small(60, 80, std::uint8_t{0});
  EXPECT_THROW((void)withoutInhibited(frame.pool, frame.scene.seen, small), std::invalid_argument);
  EXPECT_THROW(noteFamiliar(frame.pool, frame.scene.seen, small), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
