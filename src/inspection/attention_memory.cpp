#include "inspection/attention_memory.hpp"

#include <algorithm>
#include <unordered_map>

namespace saccade {
namespace {

LeafKey firstLeafOf(LeafBlock block) {
  const LeafKey half = LeafKey::fromPacked(block.packed);
  return {static_cast<std::uint16_t>(2 * half.x), static_cast<std::uint16_t>(2 * half.y),
          static_cast<std::uint16_t>(2 * half.z)};
}

Eigen::AlignedBox3d boxOf(std::span<const LeafBlock> blocks, double leaf_size_m) {
  Eigen::AlignedBox3d box;
  for (const LeafBlock& block : blocks) {
    const LeafKey key = firstLeafOf(block);
    const Eigen::Vector3d low = (Eigen::Vector3d(key.x, key.y, key.z).array() - MapTree::kCentreKey) * leaf_size_m;
    box.extend(low);
    box.extend(low + Eigen::Vector3d::Constant(2.0 * leaf_size_m));
  }
  return box;
}

}  // namespace

AttentionMemory::AttentionMemory(const OpenSession& session)
    : leaf_size_m_(session.reader.metadata().leaf_size_m),
      log_(loadAttendLog(session.reader)),
      replay_(log_, session.config.map) {}

const std::vector<RememberedObject>& AttentionMemory::objects() {
  if (!objects_) {
    objects_.emplace();
    for (AttendedObject& object : findObjects(log_)) {
      const Eigen::AlignedBox3d box_W = boxOf(object.blocks, leaf_size_m_);
      objects_->push_back({std::move(object), box_W, {}});
    }
    noteFlags();
  }
  return *objects_;
}

void AttentionMemory::noteFlags() {
  std::unordered_map<std::uint64_t, std::vector<RememberedObject*>> owners;
  for (RememberedObject& object : *objects_) {
    for (const LeafBlock& block : object.object.blocks) owners[block.packed].push_back(&object);
  }
  for (std::size_t i = 0; i < log_.tickCount(); ++i) {
    const TickEvents& events = log_.tick(i);
    for (const LeafKey& leaf : events.flags_on) {
      const auto found = owners.find(blockOf(leaf).packed);
      if (found == owners.end()) continue;
      for (RememberedObject* object : found->second) {
        if (object->flags.empty() || object->flags.back().first != events.tick.value) {
          object->flags.emplace_back(events.tick.value, 0);
        }
        ++object->flags.back().second;
      }
    }
  }
}

ObjectInhibition AttentionMemory::inhibitionOf(const AttendedObject& object, Tick tick) {
  ObjectInhibition result;
  for (const LeafBlock& block : object.blocks) {
    const LeafKey first = firstLeafOf(block);
    for (unsigned i = 0; i < 8; ++i) {
      const LeafKey leaf{static_cast<std::uint16_t>(first.x + (i & 1u)),
                         static_cast<std::uint16_t>(first.y + (i >> 1 & 1u)),
                         static_cast<std::uint16_t>(first.z + (i >> 2))};
      const IorState state = replay_.stateAt(leaf, tick);
      if (!inhibited(state, tick)) continue;
      result.first_expiry = result.inhibited == 0 ? state.expiry() : std::min(result.first_expiry, state.expiry());
      result.last_expiry = std::max(result.last_expiry, state.expiry());
      ++result.inhibited;
    }
  }
  return result;
}

std::vector<LeafKey> AttentionMemory::leavesOf(Tick tick, int rank) const {
  std::size_t low = 0;
  for (std::size_t high = log_.tickCount(); low < high;) {
    const std::size_t middle = (low + high) / 2;
    if (log_.tick(middle).tick < tick) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == log_.tickCount() || log_.tick(low).tick != tick) return {};
  for (std::size_t candidate = 0; candidate < log_.candidateCount(low); ++candidate) {
    if (log_.rank(low, candidate) == rank) return log_.leaves(low, candidate);
  }
  return {};
}

}  // namespace saccade
