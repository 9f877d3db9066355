#include "saccade/map/attend_log.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace saccade {
namespace {

std::vector<LeafKey> randomKeys(std::mt19937& random, int count, int spread) {
  std::uniform_int_distribution<int> offset(0, spread);
  std::vector<LeafKey> keys;
  for (int i = 0; i < count; ++i) {
    const auto one = [&] { return static_cast<std::uint16_t>(32760 + offset(random)); };
    const auto x = one(), y = one(), z = one();
    keys.push_back({x, y, z});
  }
  return keys;
}

TEST(AttendLog, AnswersAsASlowTwinThatKeepsEverything) {
  std::mt19937 random(5);
  AttendLog log;
  std::map<LeafKey, std::vector<AttendedBy>> twin;
  for (std::uint32_t t = 0; t < 60; ++t) {
    std::vector<std::vector<LeafKey>> masks;
    for (int c = 0; c < 5; ++c) masks.push_back(randomKeys(random, 40, 15));
    std::vector<CandidateLeaves> candidates;
    for (int c = 0; c < 5; ++c) candidates.push_back({c, masks[static_cast<std::size_t>(c)]});
    // Revisits are asked for before the tick is recorded.
    for (const auto& mask : masks) {
      std::vector<LeafKey> keys = mask;
      std::sort(keys.begin(), keys.end());
      keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
      const auto seen = std::count_if(keys.begin(), keys.end(), [&](const LeafKey& k) { return twin.count(k) != 0; });
      ASSERT_DOUBLE_EQ(log.revisitedShare(mask, Tick{3 * t}),
                       static_cast<double>(seen) / static_cast<double>(keys.size()));
    }
    log.record({Tick{3 * t}, FrameIndex{t}, {}, {}}, candidates);
    for (int c = 0; c < 5; ++c) {
      for (const LeafKey& key : masks[static_cast<std::size_t>(c)]) {
        const AttendedBy by{Tick{3 * t}, FrameIndex{t}, c};
        auto& list = twin[key];
        if (list.empty() || list.back() != by) list.push_back(by);
      }
    }
  }
  EXPECT_EQ(log.leafCount(), twin.size());
  for (const auto& [key, list] : twin) ASSERT_EQ(log.attentionsOf(key), list);
  EXPECT_TRUE(log.attentionsOf({0, 0, 0}).empty());
}

TEST(AttendLog, GivesBackTheLeavesAndEventsOfEachTick) {
  AttendLog log;
  const std::vector<LeafKey> keys{{65535, 0, 65535}, {0, 65535, 0}, {65535, 0, 65535}, {1, 2, 3}};
  log.record({Tick{4}, FrameIndex{40}, {{1, 2, 3}}, {{7, 8, 9}}}, std::vector<CandidateLeaves>{{2, keys}, {5, {}}});
  ASSERT_EQ(log.tickCount(), 1u);
  ASSERT_EQ(log.candidateCount(0), 2u);
  EXPECT_EQ(log.rank(0, 1), 5);
  std::vector<LeafKey> leaves = log.leaves(0, 0);
  std::sort(leaves.begin(), leaves.end());
  EXPECT_EQ(leaves, (std::vector<LeafKey>{{0, 65535, 0}, {1, 2, 3}, {65535, 0, 65535}}));
  EXPECT_TRUE(log.leaves(0, 1).empty());
  EXPECT_EQ(log.tick(0).flags_on, (std::vector<LeafKey>{{1, 2, 3}}));
  EXPECT_EQ(log.tick(0).forgotten, (std::vector<LeafKey>{{7, 8, 9}}));
}

TEST(AttendLog, CountsOnlyEarlierTicksAsRevisits) {
  AttendLog log;
  const std::vector<LeafKey> keys{{1, 1, 1}};
  EXPECT_EQ(log.revisitedShare(keys, Tick{0}), 0.0);
  EXPECT_EQ(log.revisitedShare({}, Tick{5}), 0.0);
  log.record({Tick{5}, {}, {}, {}}, std::vector<CandidateLeaves>{{0, keys}});
  EXPECT_EQ(log.revisitedShare(keys, Tick{5}), 0.0);
  EXPECT_EQ(log.revisitedShare(keys, Tick{6}), 1.0);
}

TEST(AttendLog, RefusesTicksThatDoNotRise) {
  AttendLog log;
  log.record({Tick{5}, {}, {}, {}}, {});
  EXPECT_THROW(log.record({Tick{5}, {}, {}, {}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
