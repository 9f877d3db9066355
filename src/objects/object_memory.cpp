#include "saccade/objects/object_memory.hpp"

#include <algorithm>

#include "saccade/session/session_map.hpp"

namespace saccade {
namespace {

/// Share of an object's looks that must have covered a block that counts as the object's.
constexpr std::uint32_t kCoreShare = 4;  // a quarter

std::vector<LeafBlock> distinctBlocks(std::span<const LeafKey> leaves) {
  std::vector<LeafBlock> blocks;
  blocks.reserve(leaves.size());
  for (const LeafKey& leaf : leaves) blocks.push_back(blockOf(leaf));
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

}  // namespace

const ObjectLook& AttendedObject::bestView() const {
  return *std::max_element(looks.begin(), looks.end(),
                           [](const ObjectLook& a, const ObjectLook& b) { return a.blocks < b.blocks; });
}

std::uint32_t ObjectMemory::Entry::coreLooks() const {
  return (static_cast<std::uint32_t>(looks.size()) + kCoreShare - 1) / kCoreShare;
}

std::uint32_t ObjectMemory::Entry::coreSize() const {
  std::uint32_t size = 0;
  for (std::size_t looks_of_block = coreLooks(); looks_of_block < with_looks.size(); ++looks_of_block) {
    size += with_looks[looks_of_block];
  }
  return size;
}

ObjectMemory::ObjectMemory(const Config& config) : config_(config) {
  requireValid(config_);
}

ObjectId ObjectMemory::observe(Tick tick, FrameIndex frame, const CandidateLeaves& candidate) {
  const std::vector<LeafBlock> blocks = distinctBlocks(candidate.leaves);
  const ObjectLook look{tick, frame, candidate.rank, static_cast<int>(blocks.size())};
  const Match match = bestMatch(blocks);
  if (match.overlap < config_.least_overlap) {
    entries_.emplace_back();
    addLook(static_cast<std::uint32_t>(entries_.size() - 1), look, blocks);
    return {static_cast<int>(entries_.size())};
  }
  if (entries_[match.object].looks.back().tick != tick) addLook(match.object, look, blocks);
  return {static_cast<int>(match.object + 1)};
}

ObjectMemory::Match ObjectMemory::bestMatch(std::span<const LeafBlock> blocks) {
  votes_.assign(entries_.size(), 0);
  std::vector<std::uint32_t> met;
  for (const LeafBlock& block : blocks) {
    const auto found = presences_.find(block.packed);
    if (found == presences_.end()) continue;
    for (const Presence& presence : found->second) {
      if (presence.looks < entries_[presence.object].coreLooks()) continue;
      if (votes_[presence.object]++ == 0) met.push_back(presence.object);
    }
  }
  std::sort(met.begin(), met.end());  // of equal overlaps the oldest object's counts
  Match best;
  for (const std::uint32_t object : met) {
    const double common = votes_[object];
    const double overlap = common / (static_cast<double>(blocks.size()) + entries_[object].coreSize() - common);
    if (overlap > best.overlap) best = {object, overlap};
  }
  return best;
}

void ObjectMemory::addLook(std::uint32_t object, const ObjectLook& look, std::span<const LeafBlock> blocks) {
  Entry& entry = entries_[object];
  entry.looks.push_back(look);
  entry.with_looks.resize(entry.looks.size() + 1);
  for (const LeafBlock& block : blocks) {
    std::vector<Presence>& there = presences_[block.packed];
    auto presence = std::find_if(there.begin(), there.end(), [&](const Presence& p) { return p.object == object; });
    if (presence == there.end()) {
      there.push_back({object, 0});
      presence = there.end() - 1;
      entry.blocks.push_back(block);
    } else {
      --entry.with_looks[presence->looks];
    }
    ++entry.with_looks[++presence->looks];
  }
}

std::vector<AttendedObject> ObjectMemory::objects(int least_looks) const {
  std::vector<AttendedObject> objects;
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (static_cast<int>(entry.looks.size()) < least_looks) continue;
    AttendedObject object{{static_cast<int>(i + 1)}, entry.looks, {}};
    for (const LeafBlock& block : entry.blocks) {
      const std::vector<Presence>& there = presences_.at(block.packed);
      const auto presence = std::find_if(there.begin(), there.end(), [&](const Presence& p) { return p.object == i; });
      if (presence->looks >= entry.coreLooks()) object.blocks.push_back(block);
    }
    std::sort(object.blocks.begin(), object.blocks.end());
    objects.push_back(std::move(object));
  }
  return objects;
}

void ObjectMemory::observe(const AttendLog& log, std::size_t tick) {
  for (std::size_t candidate = 0; candidate < log.candidateCount(tick); ++candidate) {
    const std::vector<LeafKey> leaves = log.leaves(tick, candidate);
    observe(log.tick(tick).tick, log.tick(tick).frame, {log.rank(tick, candidate), leaves});
  }
}

std::vector<AttendedObject> findObjects(const AttendLog& log, int least_looks, const ObjectMemoryConfig& config) {
  ObjectMemory memory(config);
  for (std::size_t i = log.firstAtHand(); i < log.tickCount(); ++i) memory.observe(log, i);
  return memory.objects(least_looks);
}

std::vector<AttendedObject> findObjects(const SessionReader& session, int least_looks,
                                        const ObjectMemoryConfig& config) {
  ObjectMemory memory(config);
  visitAttendLog(session, [&](const AttendLog& log, std::size_t tick) { memory.observe(log, tick); });
  return memory.objects(least_looks);
}

std::array<LeafKey, 8> leavesOf(LeafBlock block) {
  const LeafKey half = LeafKey::fromPacked(block.packed);
  std::array<LeafKey, 8> leaves;
  for (unsigned i = 0; i < 8; ++i) {
    leaves[i] = {static_cast<std::uint16_t>(half.x << 1 | (i & 1u)),
                 static_cast<std::uint16_t>(half.y << 1 | (i >> 1 & 1u)),
                 static_cast<std::uint16_t>(half.z << 1 | i >> 2)};
  }
  return leaves;
}

std::vector<LeafKey> leavesOf(const AttendedObject& object, const IorMap& map) {
  std::vector<LeafKey> leaves;
  for (const LeafBlock& block : object.blocks) {
    for (const LeafKey& key : leavesOf(block)) {
      const auto leaf = map.findLeaf(key);
      if (leaf && leaf->occupied) leaves.push_back(key);
    }
  }
  return leaves;
}

Eigen::AlignedBox3d boxOf(std::span<const LeafKey> leaves, double leaf_size_m) {
  Eigen::AlignedBox3d box;
  for (const LeafKey& leaf : leaves) {
    const Eigen::Vector3d corner(leaf.x - MapTree::kCentreKey, leaf.y - MapTree::kCentreKey,
                                 leaf.z - MapTree::kCentreKey);
    box.extend(corner * leaf_size_m).extend((corner + Eigen::Vector3d::Ones()) * leaf_size_m);
  }
  return box;
}

}  // namespace saccade
