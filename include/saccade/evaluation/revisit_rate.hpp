#pragma once

#include <cstdint>
#include <span>
#include <unordered_set>

namespace saccade {

/// Counts how often attention returns to where it has been: a candidate is a revisit if at least half of its leaves
/// were attended at any earlier tick. Reads the log of what was attended, not the IOR flags, so that it judges runs
/// without inhibition too.
///
/// `LeafId` is whatever names a leaf uniquely for the caller (a packed key).
class RevisitCounter {
 public:
  using LeafId = std::uint64_t;

  /// Judges one attended candidate of the current tick by the leaves of earlier ticks. Candidates without leaves are
  /// not counted.
  void addCandidate(std::span<const LeafId> leaves);
  /// Ends the tick: its leaves are "earlier" from now on.
  void closeTick();

  [[nodiscard]] std::int64_t candidates() const { return candidates_; }
  [[nodiscard]] std::int64_t revisits() const { return revisits_; }
  /// revisits / candidates; 0 if there are none.
  [[nodiscard]] double rate() const {
    return candidates_ > 0 ? static_cast<double>(revisits_) / static_cast<double>(candidates_) : 0.0;
  }

 private:
  std::unordered_set<LeafId> earlier_, current_;
  std::int64_t candidates_ = 0, revisits_ = 0;
};

}  // namespace saccade
