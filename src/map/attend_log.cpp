#include "saccade/map/attend_log.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>

#include "map/endpoint_leaves.hpp"

namespace saccade {
namespace {

std::uint32_t gather(std::uint64_t code) {
  code &= 0x1249249249249249;
  code = (code | code >> 2) & 0x10C30C30C30C30C3;
  code = (code | code >> 4) & 0x100F00F00F00F00F;
  code = (code | code >> 8) & 0x1F0000FF0000FF;
  code = (code | code >> 16) & 0x1F00000000FFFF;
  return static_cast<std::uint32_t>(code | code >> 32) & 0x1FFFFFu;
}

std::uint64_t codeOf(LeafKey key) {
  return mortonCode(key.x, key.y, key.z);
}

LeafKey keyOf(std::uint64_t code) {
  return {static_cast<std::uint16_t>(gather(code)), static_cast<std::uint16_t>(gather(code >> 1)),
          static_cast<std::uint16_t>(gather(code >> 2))};
}

void putVarint(std::vector<std::uint8_t>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}

std::vector<LeafKey> distinct(std::span<const LeafKey> leaves) {
  std::vector<LeafKey> keys(leaves.begin(), leaves.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

}  // namespace

template <typename Visit>
void AttendLog::visitCodes(const CandidateEntry& entry, const Visit& visit) const {
  const std::uint8_t* byte = bytes_.data() + entry.begin;
  std::uint64_t code = 0;
  for (std::uint32_t i = 0; i < entry.leaf_count; ++i) {
    std::uint64_t step = 0;
    for (int shift = 0;; shift += 7) {
      step |= static_cast<std::uint64_t>(*byte & 0x7Fu) << shift;
      if ((*byte++ & 0x80u) == 0) break;
    }
    code += step;
    visit(code);
  }
}

void AttendLog::record(const TickEvents& events, std::span<const CandidateLeaves> candidates) {
  if (!ticks_.empty() && events.tick <= ticks_.back().events.tick) {
    throw std::invalid_argument("tick " + std::to_string(events.tick.value) + " is not later than the last, " +
                                std::to_string(ticks_.back().events.tick.value));
  }
  const auto begin = static_cast<std::uint32_t>(candidates_.size());
  for (const CandidateLeaves& candidate : candidates) {
    codes_.clear();
    for (const LeafKey& key : candidate.leaves) codes_.push_back(codeOf(key));
    std::sort(codes_.begin(), codes_.end());
    codes_.erase(std::unique(codes_.begin(), codes_.end()), codes_.end());
    candidates_.push_back({candidate.rank, static_cast<std::uint32_t>(codes_.size()),
                           codes_.empty() ? 1 : codes_.front(), codes_.empty() ? 0 : codes_.back(), bytes_.size()});
    std::uint64_t last = 0;
    for (const std::uint64_t code : codes_) {
      putVarint(bytes_, code - last);
      last = code;
      noteFirst(keyOf(code).packed(), events.tick);
    }
  }
  ticks_.push_back({events, begin, static_cast<std::uint32_t>(candidates_.size())});
}

double AttendLog::revisitedShare(std::span<const LeafKey> leaves, Tick before) const {
  const std::vector<LeafKey> keys = distinct(leaves);
  if (keys.empty()) return 0.0;
  const auto revisited = std::count_if(keys.begin(), keys.end(), [&](const LeafKey& key) {
    const FirstTick* first = findFirst(key.packed());
    return first != nullptr && first->tick < before.value;
  });
  return static_cast<double>(revisited) / static_cast<double>(keys.size());
}

bool AttendLog::anyAttendedBefore(std::span<const LeafKey> leaves, Tick before) const {
  return std::any_of(leaves.begin(), leaves.end(), [&](const LeafKey& key) {
    const FirstTick* first = findFirst(key.packed());
    return first != nullptr && first->tick < before.value;
  });
}

std::vector<AttendedBy> AttendLog::attentionsOf(LeafKey leaf) const {
  std::vector<AttendedBy> answer;
  const std::uint64_t wanted = codeOf(leaf);
  for (const TickEntry& tick : ticks_) {
    for (std::uint32_t c = tick.begin; c < tick.end; ++c) {
      const CandidateEntry& entry = candidates_[c];
      if (wanted < entry.lowest || wanted > entry.highest) continue;
      bool found = false;
      visitCodes(entry, [&](std::uint64_t code) { found |= code == wanted; });
      if (found) answer.push_back({tick.events.tick, tick.events.frame, entry.rank});
    }
  }
  return answer;
}

int AttendLog::rank(std::size_t i, std::size_t candidate) const {
  return candidates_[ticks_[i].begin + candidate].rank;
}

std::vector<LeafKey> AttendLog::leaves(std::size_t i, std::size_t candidate) const {
  std::vector<LeafKey> keys;
  visitCodes(candidates_[ticks_[i].begin + candidate], [&](std::uint64_t code) { keys.push_back(keyOf(code)); });
  return keys;
}

std::size_t AttendLog::memoryBytes() const {
  std::size_t events = 0;
  for (const TickEntry& tick : ticks_) {
    events += (tick.events.flags_on.capacity() + tick.events.forgotten.capacity()) * sizeof(LeafKey);
  }
  return sizeof(*this) + events + ticks_.capacity() * sizeof(TickEntry) +
         candidates_.capacity() * sizeof(CandidateEntry) + bytes_.capacity() + first_.capacity() * sizeof(FirstTick);
}

const AttendLog::FirstTick* AttendLog::findFirst(std::uint64_t packed) const {
  if (first_.empty()) return nullptr;
  const std::size_t mask = first_.size() - 1;
  for (std::size_t i = std::hash<LeafKey>{}(LeafKey::fromPacked(packed)) & mask;; i = (i + 1) & mask) {
    if (first_[i].key_plus_one == packed + 1) return &first_[i];
    if (first_[i].key_plus_one == 0) return nullptr;
  }
}

void AttendLog::noteFirst(std::uint64_t packed, Tick tick) {
  if (2 * (first_count_ + 1) > first_.size()) {
    std::vector<FirstTick> old(std::max<std::size_t>(1024, 2 * first_.size()));
    old.swap(first_);
    first_count_ = 0;
    for (const FirstTick& slot : old) {
      if (slot.key_plus_one != 0) noteFirst(slot.key_plus_one - 1, Tick{slot.tick});
    }
  }
  const std::size_t mask = first_.size() - 1;
  std::size_t i = std::hash<LeafKey>{}(LeafKey::fromPacked(packed)) & mask;
  while (first_[i].key_plus_one != 0 && first_[i].key_plus_one != packed + 1) i = (i + 1) & mask;
  if (first_[i].key_plus_one != 0) return;  // ticks rise, so the one that is there is earlier
  first_[i] = {packed + 1, tick.value};
  ++first_count_;
}

}  // namespace saccade
