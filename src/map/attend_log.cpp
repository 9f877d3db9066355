#include "saccade/map/attend_log.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "saccade/map/morton_code.hpp"

namespace saccade {
namespace {

/// Leaves of one block of the index: 4 x 4 x 4.
constexpr unsigned kBlockBits = 6;
constexpr std::uint64_t kInBlock = (1u << kBlockBits) - 1;
/// Blocks of the index that come in one piece, so that it grows without being copied.
constexpr std::size_t kPieceBlocks = 256;

std::size_t hashOf(std::uint64_t block) {
  const std::uint64_t h = block * 0x9E3779B97F4A7C15ull;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

void putVarint(std::vector<std::uint8_t>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
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
    listCodes(candidate.leaves);
    candidates_.push_back({candidate.rank, static_cast<std::uint32_t>(codes_.size()),
                           codes_.empty() ? 1 : codes_.front(), codes_.empty() ? 0 : codes_.back(), bytes_.size()});
    std::uint64_t last = 0;
    for (const std::uint64_t code : codes_) {
      putVarint(bytes_, code - last);
      last = code;
    }
    noteFirst(events.tick);
  }
  ticks_.push_back({events, begin, static_cast<std::uint32_t>(candidates_.size())});
}

/// Makes codes_ of the leaves: sorted, each once.
void AttendLog::listCodes(std::span<const LeafKey> leaves) {
  codes_.clear();
  for (const LeafKey& key : leaves) codes_.push_back(mortonCode(key));
  if (!std::is_sorted(codes_.begin(), codes_.end())) std::sort(codes_.begin(), codes_.end());
  codes_.erase(std::unique(codes_.begin(), codes_.end()), codes_.end());
}

double AttendLog::revisitedShare(std::span<const LeafKey> leaves, Tick before) const {
  const auto rises = [](const LeafKey& a, const LeafKey& b) { return mortonCode(a) < mortonCode(b); };
  const auto repeats = [&](const LeafKey& a, const LeafKey& b) { return !rises(a, b); };
  std::vector<LeafKey> ordered;
  if (std::adjacent_find(leaves.begin(), leaves.end(), repeats) != leaves.end()) {
    ordered.assign(leaves.begin(), leaves.end());
    std::sort(ordered.begin(), ordered.end(), rises);
    ordered.erase(std::unique(ordered.begin(), ordered.end()), ordered.end());
    leaves = ordered;
  }
  if (leaves.empty()) return 0.0;
  std::size_t revisited = 0;
  const BlockTicks* block = nullptr;
  std::uint64_t last = ~std::uint64_t{0};
  for (const LeafKey& key : leaves) {
    const std::uint64_t code = mortonCode(key);
    if (code >> kBlockBits != last) block = findBlock(last = code >> kBlockBits);
    if (block == nullptr) continue;
    const std::uint32_t first_plus_one = (*block)[code & kInBlock];
    revisited += static_cast<std::size_t>(first_plus_one != 0 && first_plus_one <= before.value);
  }
  return static_cast<double>(revisited) / static_cast<double>(leaves.size());
}

std::vector<AttendedBy> AttendLog::attentionsOf(LeafKey leaf) const {
  std::vector<AttendedBy> answer;
  const std::uint64_t wanted = mortonCode(leaf);
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
  visitCodes(candidates_[ticks_[i].begin + candidate],
             [&](std::uint64_t code) { keys.push_back(keyOfMortonCode(code)); });
  return keys;
}

std::size_t AttendLog::memoryBytes() const {
  std::size_t events = 0;
  for (const TickEntry& tick : ticks_) {
    events += (tick.events.flags_on.capacity() + tick.events.forgotten.capacity()) * sizeof(LeafKey);
  }
  return sizeof(*this) + events + ticks_.capacity() * sizeof(TickEntry) +
         candidates_.capacity() * sizeof(CandidateEntry) + bytes_.capacity() + slots_.capacity() * sizeof(Slot) +
         pieces_.size() * kPieceBlocks * sizeof(BlockTicks);
}

AttendLog::BlockTicks& AttendLog::blockAt(std::uint32_t number) const {
  return pieces_[number / kPieceBlocks][number % kPieceBlocks];
}

AttendLog::BlockTicks* AttendLog::findBlock(std::uint64_t block) const {
  if (slots_.empty()) return nullptr;
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = hashOf(block) & mask; slots_[i].block_plus_one != 0; i = (i + 1) & mask) {
    if (slots_[i].block_plus_one == block + 1) return &blockAt(slots_[i].number);
  }
  return nullptr;
}

AttendLog::BlockTicks& AttendLog::addBlock(std::uint64_t block) {
  const auto insert = [this](Slot slot) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = hashOf(slot.block_plus_one - 1) & mask;
    while (slots_[i].block_plus_one != 0) i = (i + 1) & mask;
    slots_[i] = slot;
  };
  if (2 * (block_count_ + std::size_t{1}) > slots_.size()) {
    std::vector<Slot> old(std::max<std::size_t>(1024, 2 * slots_.size()));
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.block_plus_one != 0) insert(slot);
    }
  }
  insert({block + 1, block_count_});
  if (block_count_ % kPieceBlocks == 0) pieces_.push_back(std::make_unique<BlockTicks[]>(kPieceBlocks));
  return blockAt(block_count_++);
}

/// Notes when the leaves of codes_ were attended for the first time, where they were not before.
void AttendLog::noteFirst(Tick tick) {
  BlockTicks* block = nullptr;
  std::uint64_t last = ~std::uint64_t{0};
  for (const std::uint64_t code : codes_) {
    if (code >> kBlockBits != last) {
      last = code >> kBlockBits;
      block = findBlock(last);
      if (block == nullptr) block = &addBlock(last);
    }
    std::uint32_t& first = (*block)[code & kInBlock];
    if (first != 0) continue;  // ticks rise, so the one that is there is earlier
    first = tick.value + 1;
    ++first_count_;
  }
}

}  // namespace saccade
