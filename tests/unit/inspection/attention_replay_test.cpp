#include "saccade/inspection/attention_replay.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "saccade/map/ior_octree.hpp"
#include "saccade/session/session_map.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

constexpr int kTicks = 70;  // more than AttentionReplay::kSnapshots, so that some ticks lie between two of them
constexpr int kEdge = 6;    // leaves of the cube that is attended

LeafKey keyAt(int x, int y, int z) {
  return {static_cast<std::uint16_t>(MapTree::kCentreKey + x), static_cast<std::uint16_t>(MapTree::kCentreKey + y),
          static_cast<std::uint16_t>(MapTree::kCentreKey + z)};
}

/// A cube of occupied leaves attended at random, with the log of it and the states of all leaves after each tick.
struct AttendedCube {
  explicit AttendedCube(bool attend_blocks) : config(configOf(attend_blocks)), map(config) {
    for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
      leaves.push_back(keyAt(i % kEdge, i / kEdge % kEdge, i / (kEdge * kEdge)));
      test::setLeaf(map.tree(), leaves.back().x, leaves.back().y, leaves.back().z, true);
    }
    std::mt19937 random(7);
    states.push_back(currentStates());
    for (int tick = 0; tick < kTicks; ++tick) {
      std::vector<LeafKey> first, second;
      const int start = static_cast<int>(random() % leaves.size());
      for (int i = 0; i < 12; ++i) first.push_back(leaves[static_cast<std::size_t>(start + i) % leaves.size()]);
      if (tick % 3 == 0) second.assign(leaves.begin(), leaves.begin() + 9);
      std::vector<LeafKey> all = first;
      all.insert(all.end(), second.begin(), second.end());
      const AttentionReport report = map.attend(all);
      const CandidateLeaves candidates[] = {{0, first}, {1, second}};
      log.record({report.tick, FrameIndex{tick}, report.flags_on, {}}, candidates);
      states.push_back(currentStates());
    }
  }

  static IorMapConfig configOf(bool attend_blocks) {
    IorMapConfig config;
    config.attend_blocks = attend_blocks;
    return config;
  }
  [[nodiscard]] std::vector<IorState> currentStates() const {
    std::vector<IorState> now;
    for (const LeafKey& key : leaves) now.push_back(remembered(map.findLeaf(key)->ior, map.now()));
    return now;
  }

  IorMapConfig config;
  IorMap map;
  AttendLog log;
  std::vector<LeafKey> leaves;
  std::vector<std::vector<IorState>> states;  // by tick
};

class AttentionReplayOf : public testing::TestWithParam<bool> {};

TEST_P(AttentionReplayOf, KnownLeavesIsTheMapsOwnMemoryAtEveryTickInAnyOrder) {
  const AttendedCube cube(GetParam());
  AttentionReplay replay(cube.log, cube.config);
  for (int step = 0; step <= kTicks; ++step) {
    const auto tick = static_cast<std::uint32_t>(step * 37 % (kTicks + 1));
    for (std::size_t i = 0; i < cube.leaves.size(); ++i) {
      ASSERT_EQ(replay.stateAt(cube.leaves[i], Tick{tick}), cube.states[tick][i]) << "tick " << tick << " leaf " << i;
    }
  }
}

TEST_P(AttentionReplayOf, AllLeavesIsWhatItsBytesSay) {
  const AttendedCube cube(GetParam());
  AttentionReplay replay(cube.log, cube.config);
  const Tick tick{40};
  std::map<LeafKey, std::pair<std::uint32_t, bool>> expected, found;
  replay.visitRemembered(tick, [&](LeafKey key, IorState state) {
    expected[key] = {weight(state, tick), inhibited(state, tick)};
  });
  ASSERT_FALSE(expected.empty());
  const std::string bytes = replay.encode(tick);
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint16_t corner[4];
    std::uint32_t count = 0;
    std::memcpy(corner, bytes.data() + at, sizeof corner);
    std::memcpy(&count, bytes.data() + at + sizeof corner, sizeof count);
    at += sizeof corner + sizeof count;
    for (; count > 0; --count, at += sizeof(std::uint32_t)) {
      std::uint32_t entry = 0;
      std::memcpy(&entry, bytes.data() + at, sizeof entry);
      const unsigned members = (entry >> 19 & 1u) != 0 ? 8 : 1;
      for (unsigned member = 0; member < members; ++member) {
        const LeafKey inside = leafKeyOf((entry & 0x3FFFFu) + member);
        const LeafKey key{static_cast<std::uint16_t>(corner[0] + inside.x),
                          static_cast<std::uint16_t>(corner[1] + inside.y),
                          static_cast<std::uint16_t>(corner[2] + inside.z)};
        found[key] = {entry >> 20, (entry >> 18 & 1u) != 0};
      }
    }
  }
  EXPECT_EQ(found, expected);
}

INSTANTIATE_TEST_SUITE_P(LeavesAndBlocks, AttentionReplayOf, testing::Bool());

TEST(AttentionReplay, AgreesWithASavedSessionAtItsEnd) {
  const SessionReader session(SACCADE_SOURCE_DIR "/maps/desk_before.saccade");
  const IorMap map = loadMap(session);
  const AttendLog log = loadAttendLog(session);
  AttentionReplay replay(log, map.config());
  int with_flag = 0, with_weight = 0, wrong_flags = 0, wrong_weights = 0;
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (!leaf.occupied || leaf.key.depth != MapTree::kDepth) return;
    const IorState state = replay.stateAt(leaf.key.corner, map.now());
    with_flag += inhibited(leaf.ior, map.now());
    with_weight += weight(leaf.ior, map.now()) > 0;
    wrong_flags += inhibited(state, map.now()) != inhibited(leaf.ior, map.now());
    const auto difference = std::abs(static_cast<std::int64_t>(weight(state, map.now())) -
                                     static_cast<std::int64_t>(weight(leaf.ior, map.now())));
    // Without the flag a leaf may have become occupied after some of its block's looks.
    wrong_weights += difference > (inhibited(leaf.ior, map.now()) ? 0 : map.config().ior.ior_limit - 1);
  });
  EXPECT_GT(with_flag, 100);
  EXPECT_GT(with_weight, with_flag);
  EXPECT_EQ(wrong_flags, 0);
  EXPECT_EQ(wrong_weights, 0);
}

TEST(AttentionReplay, ForgetsALeafThatTurnedFree) {
  AttendLog log;
  const std::vector<LeafKey> leaf{keyAt(0, 0, 0)};
  const CandidateLeaves candidates[] = {{0, leaf}};
  log.record({Tick{0}, FrameIndex{0}, {}, {}}, candidates);
  log.record({Tick{1}, FrameIndex{1}, {}, leaf}, {});
  IorMapConfig config;
  config.attend_blocks = false;
  AttentionReplay replay(log, config);
  EXPECT_EQ(weight(replay.stateAt(leaf[0], Tick{1}), Tick{1}), 1u);
  EXPECT_EQ(replay.stateAt(leaf[0], Tick{2}), IorState{});
}

TEST(AttentionsOf, ALeafAreThoseOfItsBlockOnlyWhereBlocksAttendTogether) {
  AttendLog log;
  const std::vector<LeafKey> own{keyAt(0, 0, 0)}, neighbour{keyAt(1, 1, 1)}, other{keyAt(2, 0, 0)};
  const CandidateLeaves candidates[] = {{0, own}, {1, neighbour}, {2, other}};
  log.record({Tick{4}, FrameIndex{9}, {}, {}}, candidates);
  const std::vector<AttendedBy> alone{{Tick{4}, FrameIndex{9}, 0}};
  const std::vector<AttendedBy> together{{Tick{4}, FrameIndex{9}, 0}, {Tick{4}, FrameIndex{9}, 1}};
  EXPECT_EQ(attentionsOf(log, own[0], false), alone);
  EXPECT_EQ(attentionsOf(log, own[0], true), together);
}

}  // namespace
}  // namespace saccade
