#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "inspection/open_session.hpp"
#include "saccade/inspection/attention_replay.hpp"
#include "saccade/objects/object_memory.hpp"

namespace saccade {

/// An object with what the attend log says of its inhibition.
struct RememberedObject {
  AttendedObject object;
  Eigen::AlignedBox3d box_W;                         ///< of its blocks
  std::vector<std::pair<std::uint32_t, int>> flags;  ///< tick and number of its leaves whose flag went on
};

/// How much of an object is inhibited at a tick.
struct ObjectInhibition {
  int inhibited = 0;               ///< leaves
  std::uint32_t first_expiry = 0;  ///< tick at which the first of them will be forgotten; 0: none is inhibited
  std::uint32_t last_expiry = 0;   ///< tick at which the last will be
};

/// Everything that a session's attend log answers: states of leaves at any tick, and objects. Not thread-safe.
class AttentionMemory {
 public:
  /// Cost: a pass over the log.
  explicit AttentionMemory(const OpenSession& session);
  AttentionMemory(const AttentionMemory&) = delete;
  AttentionMemory& operator=(const AttentionMemory&) = delete;

  [[nodiscard]] const AttendLog& log() const { return log_; }
  [[nodiscard]] AttentionReplay& replay() { return replay_; }
  /// What was looked at more than once; found at the first call.
  [[nodiscard]] const std::vector<RememberedObject>& objects();
  [[nodiscard]] ObjectInhibition inhibitionOf(const AttendedObject& object, Tick tick);
  /// The leaves that the candidate of a rank attended in a tick; empty if there is none.
  [[nodiscard]] std::vector<LeafKey> leavesOf(Tick tick, int rank) const;

 private:
  void noteFlags();

  double leaf_size_m_;
  AttendLog log_;
  AttentionReplay replay_;
  std::optional<std::vector<RememberedObject>> objects_;
};

}  // namespace saccade
