#pragma once

#include <cstdint>
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

/// Why an object is, or is not, inhibited.
struct ObjectHistory {
  std::vector<LeafEvent> flags_on;   ///< its IOR flags came on, oldest first
  std::vector<LeafEvent> forgotten;  ///< its leaves turned free while they were remembered
  int leaves = 0;                    ///< occupied now
  int attended = 0;                  ///< of these, with some IOR weight now
  int inhibited = 0;                 ///< of these, inhibited now
  std::uint32_t next_expiry = 0;     ///< tick at which the first inhibited leaf will be forgotten; 0: none is
  std::uint32_t last_expiry = 0;     ///< tick at which the last inhibited leaf will be; 0: none is
};

/// From the log and the object's leaves. Cost: the log's events, and a look-up for each leaf.
[[nodiscard]] ObjectHistory historyOf(const AttendedObject& object, const AttendLog& log, const IorMap& map);

}  // namespace saccade
