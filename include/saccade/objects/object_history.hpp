#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "saccade/map/attend_log.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/objects/object_memory.hpp"

namespace saccade {

/// Number of an object's leaves that something happened to in one tick.
struct LeafEvent {
  Tick tick;
  FrameIndex frame;
  int leaves = 0;
};

/// What the map remembers of an object.
struct ObjectAttention {
  int leaves = 0;                 ///< occupied now
  int attended = 0;               ///< of these, with some IOR weight now
  int inhibited = 0;              ///< of these, inhibited now
  std::uint32_t next_expiry = 0;  ///< tick at which the first inhibited leaf will be forgotten; 0: none is
  std::uint32_t last_expiry = 0;  ///< tick at which the last inhibited leaf will be; 0: none is
};

/// Why an object is, or is not, inhibited.
struct ObjectHistory : ObjectAttention {
  std::vector<LeafEvent> flags_on;   ///< its IOR flags came on, oldest first
  std::vector<LeafEvent> forgotten;  ///< its leaves turned free while they were remembered
};

/// From an object's `leaves`, as leavesOf() gives them. Cost: a look-up for each.
[[nodiscard]] ObjectAttention attentionOf(std::span<const LeafKey> leaves, const IorMap& map);

/// From the log and the object's leaves. Cost: all of the log's events, so not for each object of a session, and a
/// look-up for each leaf.
[[nodiscard]] ObjectHistory historyOf(const AttendedObject& object, const AttendLog& log, const IorMap& map);

}  // namespace saccade
