#include "sources/stamp_pairer.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace saccade {
namespace {

using Pairer = StampPairer<int, int>;

std::vector<std::pair<int, int>> drain(Pairer& pairer) {
  std::vector<std::pair<int, int>> pairs;
  while (const auto pair = pairer.next()) pairs.emplace_back(pair->first, pair->second);
  return pairs;
}

TEST(StampPairer, PairsStreamsThatComeInAnyOrder) {
  Pairer pairer;
  for (int i = 0; i < 5; ++i) pairer.addFirst(i / 30.0, i);
  EXPECT_TRUE(drain(pairer).empty());
  for (int i = 0; i < 5; ++i) pairer.addSecond(i / 30.0 + 0.003, 10 + i);
  EXPECT_EQ(drain(pairer), (std::vector<std::pair<int, int>>{{0, 10}, {1, 11}, {2, 12}, {3, 13}, {4, 14}}));
  EXPECT_EQ(pairer.dropped(), 0);
}

TEST(StampPairer, DropsAndCountsWhatHasNoPartner) {
  Pairer pairer;
  for (const int i : {0, 1, 3}) pairer.addFirst(i / 30.0, i);
  for (const int i : {0, 2, 3}) pairer.addSecond(i / 30.0, i);
  EXPECT_EQ(drain(pairer), (std::vector<std::pair<int, int>>{{0, 0}, {3, 3}}));
  EXPECT_EQ(pairer.dropped(), 2);
}

TEST(StampPairer, WaitsForANearerFollower) {
  Pairer pairer;
  pairer.addFirst(0.000, 0);
  pairer.addSecond(0.018, 5);
  EXPECT_FALSE(pairer.next()) << "the next of the first stream may be nearer";
  pairer.addFirst(0.020, 1);
  EXPECT_EQ(drain(pairer), (std::vector<std::pair<int, int>>{{1, 5}}));
  pairer.addFirst(1.000, 2);
  pairer.addSecond(1.018, 6);
  pairer.end();
  EXPECT_EQ(drain(pairer), (std::vector<std::pair<int, int>>{{2, 6}})) << "nothing nearer can come any more";
}

}  // namespace
}  // namespace saccade
