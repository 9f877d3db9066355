#include "saccade/objects/object_history.hpp"

#include <algorithm>
#include <span>

namespace saccade {
namespace {

int countWithin(std::span<const LeafKey> leaves, const AttendedObject& object) {
  return static_cast<int>(std::count_if(leaves.begin(), leaves.end(), [&](const LeafKey& leaf) {
    return std::binary_search(object.blocks.begin(), object.blocks.end(), blockOf(leaf));
  }));
}

}  // namespace

ObjectHistory historyOf(const AttendedObject& object, const AttendLog& log, const IorMap& map) {
  ObjectHistory history;
  for (std::size_t i = 0; i < log.tickCount(); ++i) {
    const TickEvents& events = log.tick(i);
    const int on = countWithin(events.flags_on, object), forgotten = countWithin(events.forgotten, object);
    if (on > 0) history.flags_on.push_back({events.tick, events.frame, on});
    if (forgotten > 0) history.forgotten.push_back({events.tick, events.frame, forgotten});
  }
  for (const LeafKey& key : leavesOf(object, map)) {
    const IorState ior = map.findLeaf(key)->ior;
    ++history.leaves;
    history.attended += weight(ior, map.now()) > 0 ? 1 : 0;
    if (!inhibited(ior, map.now())) continue;
    ++history.inhibited;
    history.next_expiry = history.next_expiry == 0 ? ior.expiry() : std::min(history.next_expiry, ior.expiry());
    history.last_expiry = std::max(history.last_expiry, ior.expiry());
  }
  return history;
}

}  // namespace saccade
