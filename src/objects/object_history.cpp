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

ObjectAttention attentionOf(std::span<const LeafKey> leaves, const IorMap& map) {
  ObjectAttention attention;
  for (const LeafKey& key : leaves) {
    const IorState ior = map.findLeaf(key)->ior;
    ++attention.leaves;
    attention.attended += weight(ior, map.now()) > 0 ? 1 : 0;
    if (!inhibited(ior, map.now())) continue;
    ++attention.inhibited;
    attention.next_expiry = attention.next_expiry == 0 ? ior.expiry() : std::min(attention.next_expiry, ior.expiry());
    attention.last_expiry = std::max(attention.last_expiry, ior.expiry());
  }
  return attention;
}

ObjectHistory historyOf(const AttendedObject& object, const AttendLog& log, const IorMap& map) {
  ObjectHistory history{attentionOf(leavesOf(object, map), map), {}, {}};
  for (std::size_t i = 0; i < log.tickCount(); ++i) {
    const TickEvents& events = log.tick(i);
    const int on = countWithin(events.flags_on, object), forgotten = countWithin(events.forgotten, object);
    if (on > 0) history.flags_on.push_back({events.tick, events.frame, on});
    if (forgotten > 0) history.forgotten.push_back({events.tick, events.frame, forgotten});
  }
  return history;
}

}  // namespace saccade
