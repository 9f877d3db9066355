#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "saccade/core/frame.hpp"
#include "saccade/map/ior_law.hpp"
#include "saccade/map/leaf_key.hpp"

namespace saccade {

/// Which leaves one candidate of a frame covers.
struct CandidateLeaves {
  int rank = 0;  ///< the candidate's rank in its frame
  std::span<const LeafKey> leaves;
};

/// What happened in one tick, besides which leaves each candidate attended.
struct TickEvents {
  Tick tick;
  FrameIndex frame;
  std::vector<LeafKey> flags_on;   ///< leaves whose IOR flag went on
  std::vector<LeafKey> forgotten;  ///< leaves that turned free while they still had IOR weight
};

/// One attention of a leaf, as an answer of the log.
struct AttendedBy {
  Tick tick;
  FrameIndex frame;
  int rank = 0;
  friend bool operator==(const AttendedBy&, const AttendedBy&) = default;
};

/// Record of every attention: what `why` and the revisit rate are answered from (DESIGN, "The IOR law").
///
/// Kept in memory as differences of sorted keys, one to three bytes a leaf, and an index of the first tick of each leaf
/// ever attended, by blocks of 4 x 4 x 4 leaves: those of a candidate lie close together. It only grows. One writer, or
/// any number of readers; leaves in Morton order are recorded and asked for fastest.
class AttendLog {
 public:
  /// Adds one tick; ticks must rise. The leaves of a candidate may come in any order and repeated.
  /// Throws std::invalid_argument for a tick not later than the last.
  void record(const TickEvents& events, std::span<const CandidateLeaves> candidates);

  /// Share of the different `leaves` that were attended at any tick before `before`, 0..1; 0 for no leaves. A candidate
  /// with 0.5 or more is a revisit.
  [[nodiscard]] double revisitedShare(std::span<const LeafKey> leaves, Tick before) const;
  /// All attentions of a leaf, oldest first. Cost: passes over the log, skipping candidates that lie elsewhere.
  [[nodiscard]] std::vector<AttendedBy> attentionsOf(LeafKey leaf) const;

  /// The recorded ticks, oldest first.
  [[nodiscard]] std::size_t tickCount() const { return ticks_.size(); }
  [[nodiscard]] const TickEvents& tick(std::size_t i) const { return ticks_[i].events; }
  /// Number of candidates attended in the i-th tick, and their ranks and leaves (in Morton order).
  [[nodiscard]] std::size_t candidateCount(std::size_t i) const { return ticks_[i].end - ticks_[i].begin; }
  [[nodiscard]] int rank(std::size_t i, std::size_t candidate) const;
  [[nodiscard]] std::vector<LeafKey> leaves(std::size_t i, std::size_t candidate) const;

  /// Different leaves ever attended.
  [[nodiscard]] std::size_t leafCount() const { return first_count_; }
  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  struct TickEntry {
    TickEvents events;
    std::uint32_t begin, end;  // in candidates_
  };
  struct CandidateEntry {
    int rank;
    std::uint32_t leaf_count;
    std::uint64_t lowest, highest;  // Morton codes
    std::uint64_t begin;            // in bytes_
  };
  using BlockTicks = std::array<std::uint32_t, 64>;  // 1 + the first tick of each leaf; 0: never attended
  struct Slot {
    std::uint64_t block_plus_one = 0;  // Morton code of the block; 0: empty slot
    std::uint32_t number = 0;          // of the block, in the order in which they came
  };

  template <typename Visit>
  void visitCodes(const CandidateEntry& entry, const Visit& visit) const;
  void listCodes(std::span<const LeafKey> leaves);
  void noteFirst(Tick tick);
  [[nodiscard]] BlockTicks& blockAt(std::uint32_t number) const;
  [[nodiscard]] BlockTicks* findBlock(std::uint64_t block) const;
  BlockTicks& addBlock(std::uint64_t block);

  std::vector<TickEntry> ticks_;
  std::vector<CandidateEntry> candidates_;
  std::vector<std::uint8_t> bytes_;
  std::vector<Slot> slots_;  // open addressing, a power of two
  std::vector<std::unique_ptr<BlockTicks[]>> pieces_;
  std::uint32_t block_count_ = 0;
  std::size_t first_count_ = 0;
  std::vector<std::uint64_t> codes_;  // scratch
};

}  // namespace saccade
