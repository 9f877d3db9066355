#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "saccade/map/attend_log.hpp"
#include "saccade/map/ior_map.hpp"

namespace saccade {

/// All attentions of a leaf, oldest first; with `attend_blocks` those of any leaf of its block of 2×2×2 count, as they
/// do for the map. Each look (tick, rank) once. Cost: a pass over the log.
[[nodiscard]] std::vector<AttendedBy> attentionsOf(const AttendLog& log, LeafKey leaf, bool attend_blocks);

/// Key of the finest leaf with a Morton code (x lowest).
[[nodiscard]] LeafKey leafKeyOf(std::uint64_t morton_code);

/// The attention memory of a map as it was at any tick, replayed from the attend log by the IOR law.
///
/// The log says who attended what, which flags went on and what was forgotten, but not when a leaf became occupied, so:
/// flags are exact at every tick, weights are exact wherever the flag is on, and elsewhere at most ior_limit - 1 too
/// high, for leaves that were not yet occupied when a neighbour of theirs was looked at. States are given for whole
/// blocks of 2×2×2 where blocks attend together; which of their leaves exist is the map's to say.
///
/// Owns a few snapshots, spread evenly over time, and goes on from the nearest; moving forward tick by tick costs one
/// tick's leaves. Memory: at most kSnapshots + 1 states for each leaf of the blocks ever attended, 4 bytes each.
/// Not thread-safe.
class AttentionReplay {
 public:
  static constexpr int kSnapshots = 16;

  /// `log` must outlive the replay; `config`: that of the map that wrote it. Cost: one pass over the log.
  AttentionReplay(const AttendLog& log, const IorMapConfig& config);

  /// The state of a leaf at `tick`; none where it was never attended.
  [[nodiscard]] IorState stateAt(LeafKey leaf, Tick tick);
  /// Calls `visit` in Morton order for every leaf with a weight above 0 at `tick`.
  void visitRemembered(Tick tick, const std::function<void(LeafKey, IorState)>& visit);
  /// The same as bytes for the page of `saccade view`, little-endian: for each tile (depth 10) its corner as
  /// 3 × uint16, 2 bytes of 0, the number of entries as uint32, then the entries: Morton code in the tile (bits 0-17),
  /// inhibited (18), the code stands for its whole block of 2×2×2 (19), weight, at most 4095 (20-31).
  [[nodiscard]] std::string encode(Tick tick);

  /// Leaves for which states are kept.
  [[nodiscard]] std::size_t leafCount() const { return 8 * blocks_.size(); }

 private:
  void moveTo(Tick tick);
  void apply(std::size_t i);
  void attendBlock(std::size_t block, std::uint8_t leaves, Tick tick);
  [[nodiscard]] std::size_t findBlock(std::uint64_t block_code) const;

  struct Snapshot {
    std::size_t applied = 0;  ///< ticks of the log that are in it
    std::vector<IorState> states;
  };

  const AttendLog& log_;
  IorMapConfig config_;
  std::vector<std::uint64_t> blocks_;  ///< Morton codes of the blocks of 2×2×2, sorted
  std::vector<Snapshot> snapshots_;
  Snapshot current_;
  std::vector<std::uint64_t> flags_on_;                               ///< scratch: Morton codes, sorted
  std::vector<std::pair<std::size_t, std::uint8_t>> touched_blocks_;  ///< scratch
};

}  // namespace saccade
