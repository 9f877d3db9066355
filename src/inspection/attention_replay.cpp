#include "saccade/inspection/attention_replay.hpp"

#include <algorithm>
#include <cmath>

#include "inspection/tile_entries.hpp"
#include "saccade/map/morton_code.hpp"

namespace saccade {
namespace {

// Of an entry of encode(), above the Morton code.
constexpr std::uint32_t kInhibitedBit = 1, kBlockBit = 2;
constexpr int kWeightShift = 2;
constexpr std::uint32_t kHighestWeight = 4095;

std::uint64_t codeOf(LeafKey key) {
  return mortonCode(key);
}

}  // namespace

LeafKey leafKeyOf(std::uint64_t morton_code) {
  return keyOfMortonCode(morton_code);
}

std::vector<AttendedBy> attentionsOf(const AttendLog& log, LeafKey leaf, bool attend_blocks) {
  std::vector<AttendedBy> looks;
  const auto part = [](std::uint16_t value, unsigned upper) {
    return static_cast<std::uint16_t>((value & ~1u) | upper);
  };
  for (unsigned i = 0; i < 8; ++i) {
    const LeafKey member{part(leaf.x, i & 1u), part(leaf.y, i >> 1 & 1u), part(leaf.z, i >> 2)};
    if (!attend_blocks && member != leaf) continue;
    const std::vector<AttendedBy> of_member = log.attentionsOf(member);
    looks.insert(looks.end(), of_member.begin(), of_member.end());
  }
  const auto order = [](const AttendedBy& look) { return std::pair(look.tick, look.rank); };
  std::sort(looks.begin(), looks.end(), [&](const auto& a, const auto& b) { return order(a) < order(b); });
  looks.erase(std::unique(looks.begin(), looks.end()), looks.end());
  return looks;
}

AttentionReplay::AttentionReplay(const AttendLog& log, const IorMapConfig& config) : log_(log), config_(config) {
  for (std::size_t i = 0; i < log_.tickCount(); ++i) {
    const std::size_t known = blocks_.size();
    for (std::size_t candidate = 0; candidate < log_.candidateCount(i); ++candidate) {
      for (const LeafKey& key : log_.leaves(i, candidate)) blocks_.push_back(codeOf(key) >> 3);
    }
    std::sort(blocks_.begin() + static_cast<std::ptrdiff_t>(known), blocks_.end());
    std::inplace_merge(blocks_.begin(), blocks_.begin() + static_cast<std::ptrdiff_t>(known), blocks_.end());
    blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
  }
  current_.states.resize(leafCount());
  const std::size_t step = std::max<std::size_t>(1, (log_.tickCount() + kSnapshots - 1) / kSnapshots);
  for (std::size_t i = 0; i < log_.tickCount(); ++i) {
    if (i % step == 0) snapshots_.push_back(current_);
    apply(i);
  }
}

std::size_t AttentionReplay::findBlock(std::uint64_t block_code) const {
  const auto found = std::lower_bound(blocks_.begin(), blocks_.end(), block_code);
  return found != blocks_.end() && *found == block_code ? static_cast<std::size_t>(found - blocks_.begin())
                                                        : blocks_.size();
}

void AttentionReplay::attendBlock(std::size_t block, std::uint8_t leaves, Tick tick) {
  for (unsigned i = 0; i < 8; ++i) {
    if ((leaves >> i & 1u) == 0) continue;
    IorState& state = current_.states[8 * block + i];
    const bool flag_goes_on = std::binary_search(flags_on_.begin(), flags_on_.end(), blocks_[block] << 3 | i);
    if (flag_goes_on) {  // so it had reached the limit, whatever was not seen here
      const double w = std::ceil(config_.ior.ior_limit * config_.ior.mf);
      const double expiry = std::min<double>(tick.value + 1.0 + w, IorState::kLastExpiry);
      state = IorState(static_cast<std::uint32_t>(expiry), true);
      continue;
    }
    const std::uint32_t before = weight(state, tick);
    const bool flag = inhibited(state, tick);
    std::uint32_t w = before + 1;
    // Without the flag it had not: some of the looks counted here came before the leaf was occupied.
    if (!flag) w = std::min(w, static_cast<std::uint32_t>(std::max(config_.ior.ior_limit - 1, 1)));
    state = IorState(tick.value + 1 + w, flag);
  }
}

void AttentionReplay::apply(std::size_t i) {
  const TickEvents& events = log_.tick(i);
  flags_on_.clear();
  for (const LeafKey& key : events.flags_on) flags_on_.push_back(codeOf(key));
  std::sort(flags_on_.begin(), flags_on_.end());
  touched_blocks_.clear();
  for (std::size_t candidate = 0; candidate < log_.candidateCount(i); ++candidate) {
    for (const LeafKey& key : log_.leaves(i, candidate)) {
      const std::uint64_t code = codeOf(key);
      const std::uint8_t leaves = config_.attend_blocks ? 0xFF : static_cast<std::uint8_t>(1u << (code & 7));
      if (!touched_blocks_.empty() && blocks_[touched_blocks_.back().first] == code >> 3) {
        touched_blocks_.back().second |= leaves;
      } else {
        touched_blocks_.emplace_back(findBlock(code >> 3), leaves);
      }
    }
  }
  std::sort(touched_blocks_.begin(), touched_blocks_.end());
  for (std::size_t k = 0; k < touched_blocks_.size(); ++k) {
    std::uint8_t leaves = touched_blocks_[k].second;
    for (; k + 1 < touched_blocks_.size() && touched_blocks_[k + 1].first == touched_blocks_[k].first; ++k) {
      leaves |= touched_blocks_[k + 1].second;
    }
    attendBlock(touched_blocks_[k].first, leaves, events.tick);
  }
  for (const LeafKey& key : events.forgotten) {  // they turned free before this tick's looks, which missed them
    const std::uint64_t code = codeOf(key);
    const std::size_t block = findBlock(code >> 3);
    if (block < blocks_.size()) current_.states[8 * block + (code & 7)] = IorState{};
  }
  current_.applied = i + 1;
}

void AttentionReplay::moveTo(Tick tick) {
  std::size_t wanted = 0;  // ticks of the log before `tick`
  for (std::size_t low = 0, high = log_.tickCount(); low < high;) {
    const std::size_t middle = (low + high) / 2;
    log_.tick(middle).tick < tick ? low = middle + 1 : high = middle;
    wanted = low;
  }
  const auto later = std::upper_bound(snapshots_.begin(), snapshots_.end(), wanted,
                                      [](std::size_t w, const Snapshot& snapshot) { return w < snapshot.applied; });
  const bool behind = current_.applied > wanted;
  if (later != snapshots_.begin() && (behind || std::prev(later)->applied > current_.applied)) {
    current_ = *std::prev(later);
  }
  while (current_.applied < wanted) apply(current_.applied);
}

IorState AttentionReplay::stateAt(LeafKey leaf, Tick tick) {
  moveTo(tick);
  const std::uint64_t code = codeOf(leaf);
  const std::size_t block = findBlock(code >> 3);
  return block < blocks_.size() ? remembered(current_.states[8 * block + (code & 7)], tick) : IorState{};
}

void AttentionReplay::visitRemembered(Tick tick, const std::function<void(LeafKey, IorState)>& visit) {
  moveTo(tick);
  for (std::size_t i = 0; i < current_.states.size(); ++i) {
    if (weight(current_.states[i], tick) > 0) visit(leafKeyOf(blocks_[i / 8] << 3 | (i & 7)), current_.states[i]);
  }
}

std::string AttentionReplay::encode(Tick tick) {
  moveTo(tick);
  TileEntries entries;
  const auto add = [&](std::uint64_t code, IorState state, bool whole_block) {
    entries.add(code, (inhibited(state, tick) ? kInhibitedBit : 0u) | (whole_block ? kBlockBit : 0u) |
                          std::min(weight(state, tick), kHighestWeight) << kWeightShift);
  };
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    const IorState* states = &current_.states[8 * block];
    if (std::all_of(states + 1, states + 8, [&](IorState state) { return state == states[0]; })) {
      if (weight(states[0], tick) > 0) add(blocks_[block] << 3, states[0], true);
      continue;
    }
    for (unsigned i = 0; i < 8; ++i) {
      if (weight(states[i], tick) > 0) add(blocks_[block] << 3 | i, states[i], false);
    }
  }
  return entries.take();
}

}  // namespace saccade
