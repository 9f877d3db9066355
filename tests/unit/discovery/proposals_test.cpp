#include "saccade/discovery/proposals.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <gtest/gtest.h>

#include "saccade/discovery/ranker.hpp"
#include "support/random_scene.hpp"

namespace saccade {
namespace {

ProposalConfig anyArea() {
  ProposalConfig config;
  config.min_area = 1;
  config.max_area_share = 1.0;
  return config;
}

Candidates propose(bool distinct_boxes) {
  const test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  ProposalConfig config = anyArea();
  config.distinct_boxes = distinct_boxes;
  return proposeCandidates(scene.seen, config);
}

TEST(Proposals, HaveTheBoxAndAreaOfTheirSegments) {
  const test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  const Candidates pool = proposeCandidates(scene.seen, anyArea());
  ASSERT_FALSE(pool.empty());
  for (const Candidate& candidate : pool) {
    SegmentSums sums;
    for (const std::int32_t id : candidate.segments) sums += scene.seen.table(candidate.source).sums(id);
    EXPECT_EQ(candidate.area, sums.area);
    EXPECT_EQ(candidate.box, sums.box());
    EXPECT_TRUE(std::is_sorted(candidate.segments.begin(), candidate.segments.end()));
  }
}

TEST(Proposals, AreNeverTwiceTheSameSegments) {
  for (const bool distinct_boxes : {false, true}) {
    std::set<std::pair<CandidateSource, SegmentIds>> met;
    for (const Candidate& candidate : propose(distinct_boxes)) {
      EXPECT_TRUE(met.insert({candidate.source, candidate.segments}).second);
    }
  }
}

TEST(Proposals, OfDistinctBoxesStandForAllThatAreLeftOut) {
  // A cell is at most 1/16 of a side wide and the areas in it differ by at most 15 %.
  constexpr double kSmallestBoxOverlap = 0.75, kLargestAreaRatio = 1.16;
  const Candidates all = propose(false), distinct = propose(true);
  EXPECT_LT(distinct.size(), all.size());
  for (const Candidate& candidate : all) {
    EXPECT_TRUE(std::any_of(distinct.begin(), distinct.end(), [&](const Candidate& kept) {
      const double ratio = static_cast<double>(kept.area) / candidate.area;
      return boxIou(kept.box, candidate.box) > kSmallestBoxOverlap && ratio < kLargestAreaRatio &&
             ratio > 1.0 / kLargestAreaRatio;
    })) << candidate.box;
  }
}

TEST(Proposals, CountTheUnionsWithNearlyTheirBoxWhetherTheseAreKeptOrNot) {
  constexpr double kLeastIou = 0.7;  // as box_agreement.hpp says
  const auto agreeing = [](const Candidates& pool, const Candidate& candidate) {
    return static_cast<int>(std::count_if(pool.begin(), pool.end(), [&](const Candidate& other) {
      return boxIou(candidate.box, other.box) >= kLeastIou;
    }));
  };
  const Candidates all = propose(false), distinct = propose(true);
  for (const Candidate& candidate : all) EXPECT_EQ(candidate.unions, agreeing(all, candidate));
  int left_out = 0;
  for (const Candidate& candidate : distinct) {
    EXPECT_GE(candidate.unions, agreeing(distinct, candidate));
    left_out += candidate.unions - agreeing(distinct, candidate);
  }
  EXPECT_GT(left_out, 0);
}

TEST(Proposals, OfThePaperComeFromBlobsAlone) {
  test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  scene.seen.blobs.clear();
  ProposalConfig config = anyArea();
  config.paper = true;
  EXPECT_TRUE(proposeCandidates(scene.seen, config).empty());
}

/// The candidate made of the same segments; null if there is none.
const Candidate* findSame(const Candidates& among, const Candidate& candidate) {
  const auto same = std::find_if(among.begin(), among.end(), [&](const Candidate& other) {
    return other.source == candidate.source && other.segments == candidate.segments;
  });
  return same != among.end() ? &*same : nullptr;
}

/// Ranks without leaving anything out.
RankingConfig keepingAll(const Candidates& pool) {
  RankingConfig config;
  config.suppress = false;
  config.duplicate_iou = 1.0;
  config.max_judged = config.max_convexities = 0;
  config.min_score = 0.0;
  config.max_open = static_cast<int>(pool.size());
  return config;
}

TEST(Ranking, LeavesOutTheWorstBeforeTheirConvexityIsMeasuredAndScoresTheOthersAsEver) {
  const test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  const Candidates pool = proposeCandidates(scene.seen, anyArea());
  RankingConfig config = keepingAll(pool);
  const Candidates all = Ranker(config).rank(pool, scene.seen);
  config.max_judged = static_cast<int>(pool.size() / 2);
  const Candidates promising = Ranker(config).rank(pool, scene.seen);
  ASSERT_EQ(promising.size(), pool.size() / 2);
  for (const Candidate& candidate : promising) {
    const Candidate* same = findSame(all, candidate);
    ASSERT_NE(same, nullptr);
    EXPECT_EQ(candidate.score, same->score);
    EXPECT_EQ(candidate.features, same->features);
  }
  // A mean convexity misjudges some: none of the best tenth is lost.
  for (std::size_t i = 0; i < all.size() / 10; ++i) EXPECT_EQ(promising[i].segments, all[i].segments) << i;
}

TEST(Ranking, ScoresOnlyThePromisingByTheirOwnConvexityButMeasuresItOfAllThatAreGiven) {
  const test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  const Candidates pool = proposeCandidates(scene.seen, anyArea());
  RankingConfig config = keepingAll(pool);
  const Candidates all = Ranker(config).rank(pool, scene.seen);
  const auto promising = pool.size() / 2;
  config.max_convexities = static_cast<int>(promising);
  const Candidates some = Ranker(config).rank(pool, scene.seen);
  ASSERT_EQ(some.size(), all.size());
  std::size_t same_score = 0;
  for (const Candidate& candidate : some) {
    const Candidate* same = findSame(all, candidate);
    ASSERT_NE(same, nullptr);
    EXPECT_EQ(candidate.features, same->features);
    EXPECT_EQ(candidate.has_convexity, candidate.has_depth);
    same_score += candidate.score == same->score ? 1 : 0;
  }
  EXPECT_GE(same_score, promising);
  EXPECT_LT(same_score, some.size()) << "the others are judged by a mean one";
  for (std::size_t i = 0; i < all.size() / 10; ++i) EXPECT_EQ(some[i].segments, all[i].segments) << i;
}

TEST(Ranking, LowersTheScoreOfWhatDepthDoesNotShowAndOfNothingElse) {
  const test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  const Candidates pool = proposeCandidates(scene.seen, anyArea());
  RankingConfig config = keepingAll(pool);
  config.features.min_depth_share = 0.875;  // so that some have depth here and some have none
  const auto rank = [&](double weight) {
    config.unmeasured_weight = weight;
    return Ranker(config).rank(pool, scene.seen);
  };
  const Candidates as_judged = rank(1.0), lowered = rank(0.25);
  ASSERT_EQ(lowered.size(), as_judged.size());
  std::size_t measured = 0;
  for (const Candidate& candidate : lowered) {
    const Candidate* same = findSame(as_judged, candidate);
    ASSERT_NE(same, nullptr);
    EXPECT_EQ(candidate.score, candidate.has_depth ? same->score : 0.25 * same->score);
    measured += candidate.has_depth ? 1 : 0;
  }
  EXPECT_GT(measured, 0U);
  EXPECT_LT(measured, lowered.size());
}

TEST(Ranking, LowersTheScoreOfWhatWasAttendedBeforeByItsShare) {
  const test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  Candidates pool = proposeCandidates(scene.seen, anyArea());
  RankingConfig config = keepingAll(pool);
  const Candidates as_judged = Ranker(config).rank(pool, scene.seen);
  for (std::size_t i = 0; i < pool.size(); ++i) pool[i].familiar_share = static_cast<double>(i % 5) / 4.0;
  config.familiar_loss = 0.75;
  const Candidates lowered = Ranker(config).rank(pool, scene.seen);
  ASSERT_EQ(lowered.size(), as_judged.size());
  for (const Candidate& candidate : lowered) {
    const Candidate* same = findSame(as_judged, candidate);
    ASSERT_NE(same, nullptr);
    EXPECT_DOUBLE_EQ(candidate.score, (1.0 - 0.75 * candidate.familiar_share) * same->score);
  }
  config.familiar_loss = 0.0;
  const Candidates heedless = Ranker(config).rank(pool, scene.seen);
  ASSERT_EQ(heedless.size(), as_judged.size());
  for (std::size_t i = 0; i < heedless.size(); ++i) EXPECT_EQ(heedless[i].segments, as_judged[i].segments) << i;
}

TEST(Ranking, OfThePaperKnowsNothingOfWhatWasForgotten) {
  const test::RandomScene scene = test::randomScene({160, 120}, 60, 7);
  Candidates pool = proposeCandidates(scene.seen, anyArea());
  RankingConfig config = keepingAll(pool);
  config.paper = true;
  const Candidates before = Ranker(config).rank(pool, scene.seen);
  for (Candidate& candidate : pool) candidate.familiar_share = 1.0;
  const Candidates after = Ranker(config).rank(pool, scene.seen);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].score, before[i].score) << i;
}

TEST(Suppression, LetsADistantThingPassASecondViewOfTheBest) {
  Candidates sorted(3);
  sorted[0].box = {0, 0, 40, 40};
  sorted[0].score = 0.9;
  sorted[1].box = {2, 2, 40, 40};
  sorted[1].score = 0.8;
  sorted[2].box = {200, 100, 30, 30};
  sorted[2].score = 0.6;
  suppressOverlapping(sorted, {});
  ASSERT_EQ(sorted.size(), 3U);
  EXPECT_EQ(sorted[1].box.x, 200);
  EXPECT_EQ(sorted[1].score, 0.6);
  EXPECT_LT(sorted[2].score, 0.8);
}

TEST(Suppression, AfterTheFirstTopKPrefersWhatNoBetterOneCovers) {
  Candidates sorted(4);
  sorted[0].box = {0, 0, 40, 40};
  sorted[1].box = {4, 0, 40, 40};  // intersection over union with the first: 9/11
  sorted[2].box = {8, 0, 40, 40};  // 2/3 with the first
  sorted[3].box = {200, 100, 30, 30};
  const std::array<double, 4> scores{0.9, 0.85, 0.84, 0.45};
  for (std::size_t i = 0; i < 4; ++i) sorted[i].score = scores[i];
  RankingConfig config;
  config.top_k = 2;
  config.cover_power = 1.0;
  config.min_score = 0.0;
  suppressOverlapping(sorted, config);
  ASSERT_EQ(sorted.size(), 4U);
  EXPECT_EQ(sorted[1].box.x, 8) << "gently among the first: a score of 0.84 is still worth more than 0.45";
  EXPECT_EQ(sorted[2].box.x, 200) << "steeply after them";
  for (std::size_t i = 1; i < 4; ++i) EXPECT_LE(sorted[i].score, sorted[i - 1].score);
}

TEST(Suppression, EndsTheListWhereScoresFallBelowTheLeastButNotAmongTheFirstTopK) {
  Candidates apart(4);
  const std::array<double, 4> scores{0.5, 0.1, 0.3, 0.02};
  for (std::size_t i = 0; i < 4; ++i) apart[i].box = {100 * static_cast<int>(i), 0, 40, 40};
  const auto left = [&](int top_k, double min_score, bool paper) {
    Candidates sorted = apart;
    for (std::size_t i = 0; i < 4; ++i) sorted[i].score = scores[i];
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
    RankingConfig config;
    config.top_k = top_k;
    config.min_score = min_score;
    config.paper = paper;
    suppressOverlapping(sorted, config);
    return sorted.size();
  };
  EXPECT_EQ(left(1, 0.1, false), 3U) << "0.1 itself is enough";
  EXPECT_EQ(left(1, 0.2, false), 2U);
  EXPECT_EQ(left(3, 0.2, false), 3U) << "what is attended is not cut";
  EXPECT_EQ(left(1, 0.0, false), 4U);
  EXPECT_EQ(left(1, 0.2, true), 4U);
}

TEST(Suppression, LowersWhatLiesInsideABetterOneByTheShareThatDoes) {
  Candidates sorted(4);
  sorted[0].box = {0, 0, 100, 100};
  sorted[1].box = {10, 10, 20, 20};   // wholly inside
  sorted[2].box = {84, 40, 20, 10};   // four fifths inside
  sorted[3].box = {-10, 70, 20, 10};  // half inside
  const std::array<double, 4> scores{0.9, 0.8, 0.6, 0.5};
  for (std::size_t i = 0; i < 4; ++i) sorted[i].score = scores[i];
  RankingConfig config;
  config.inside_from = 0.6;
  config.inside_loss = 0.2;
  suppressOverlapping(sorted, config);
  ASSERT_EQ(sorted.size(), 4U);
  EXPECT_DOUBLE_EQ(sorted[1].score, 0.8 * 0.8);
  EXPECT_DOUBLE_EQ(sorted[2].score, 0.6 * 0.9);
  EXPECT_EQ(sorted[3].score, 0.5);
}

TEST(Suppression, SwitchedOffLeavesTheOrder) {
  Candidates sorted(3);
  for (std::size_t i = 0; i < 3; ++i) {
    sorted[i].box = {static_cast<int>(i), 0, 40, 40};
    sorted[i].score = 0.9 - 0.1 * static_cast<double>(i);
  }
  RankingConfig config;
  config.suppress = false;
  config.top_k = 1;
  suppressOverlapping(sorted, config);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(sorted[i].box.x, static_cast<int>(i));
}

}  // namespace
}  // namespace saccade
