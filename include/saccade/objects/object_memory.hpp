#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/attend_log.hpp"
#include "saccade/map/ior_map.hpp"

namespace saccade {

class SessionReader;

/// Number of an object, from 1 in the order of first sight; stays the same when an exploration goes on.
struct ObjectId {
  int value = 0;
  friend auto operator<=>(const ObjectId&, const ObjectId&) = default;
};

/// A block of 2x2x2 leaves, by halved keys. A measured surface is some leaves thick and every pose sees others of them;
/// blocks are what is met again (see IorMap::attend()).
struct LeafBlock {
  std::uint64_t packed = 0;  ///< as LeafKey::packed()
  friend auto operator<=>(const LeafBlock&, const LeafBlock&) = default;
};

[[nodiscard]] constexpr LeafBlock blockOf(LeafKey key) {
  return {LeafKey{static_cast<std::uint16_t>(key.x >> 1), static_cast<std::uint16_t>(key.y >> 1),
                  static_cast<std::uint16_t>(key.z >> 1)}
              .packed()};
}

/// The leaves of a block, in Morton order.
[[nodiscard]] std::array<LeafKey, 8> leavesOf(LeafBlock block);

/// One attention of an object.
struct ObjectLook {
  Tick tick;
  FrameIndex frame;  ///< in the input of its run
  int rank = 0;      ///< of the candidate
  int blocks = 0;    ///< different blocks that the candidate covered
};

/// Candidates that returned on the same leaves.
struct AttendedObject {
  ObjectId id;
  std::vector<ObjectLook> looks;  ///< oldest first, the best-ranked candidate of each tick
  std::vector<LeafBlock> blocks;  ///< where it is: what at least a quarter of its looks covered, sorted

  /// The look that covered most of it.
  [[nodiscard]] const ObjectLook& bestView() const;
};

struct ObjectMemoryConfig {
  double least_overlap = 0.4;  ///< intersection over union, in blocks, of a candidate with the object it returns to

  void describe(ConfigVisitor& v) {
    v.number("least_overlap", least_overlap, {0.05, 1.0}, "",
             "intersection over union of a candidate with the object it returns to");
  }
};

/// Joins attended candidates to objects as they come: a candidate belongs to the object that it overlaps most, if that
/// is enough, else it begins a new one. Of several candidates of a tick on one object the best-ranked counts as the
/// look; the others say nothing new.
///
/// It needs the attend log and nothing else. So old sessions have objects too, and an exploration that goes on finds
/// the same numbers again; nothing of it can be out of date. Deterministic. Cost: a look-up for each block and the
/// objects there, some 2 ms a frame of 20 candidates.
class ObjectMemory {
 public:
  using Config = ObjectMemoryConfig;

  explicit ObjectMemory(const Config& config = {});

  /// Adds a candidate; ticks must not fall, ranks rise within a tick. The object it belongs to.
  ObjectId observe(Tick tick, FrameIndex frame, const CandidateLeaves& candidate);

  /// Adds all candidates of a tick, by its number in the log.
  void observe(const AttendLog& log, std::size_t tick);

  /// The objects that were looked at in at least `least_looks` ticks, by their numbers.
  [[nodiscard]] std::vector<AttendedObject> objects(int least_looks = 2) const;

 private:
  struct Presence {
    std::uint32_t object;
    std::uint32_t looks;
  };
  struct Entry {
    std::vector<ObjectLook> looks;
    std::vector<LeafBlock> blocks;          // of all looks, in the order of first sight
    std::vector<std::uint32_t> with_looks;  // number of blocks that k looks covered
    [[nodiscard]] std::uint32_t coreLooks() const;
    [[nodiscard]] std::uint32_t coreSize() const;
  };
  struct Match {
    std::uint32_t object = 0;
    double overlap = 0.0;
  };

  Match bestMatch(std::span<const LeafBlock> blocks);
  void addLook(std::uint32_t object, const ObjectLook& look, std::span<const LeafBlock> blocks);

  Config config_;
  std::vector<Entry> entries_;
  std::unordered_map<std::uint64_t, std::vector<Presence>> presences_;  // by block
  std::vector<std::uint32_t> votes_;                                    // scratch of bestMatch(), by object
};

/// The objects of a whole log.
[[nodiscard]] std::vector<AttendedObject> findObjects(const AttendLog& log, int least_looks = 2,
                                                      const ObjectMemoryConfig& config = {});

/// The objects of a session, found tick by tick: in memory is what the objects take, not the log.
[[nodiscard]] std::vector<AttendedObject> findObjects(const SessionReader& session, int least_looks = 2,
                                                      const ObjectMemoryConfig& config = {});

/// The finest occupied leaves of the map within the object's blocks, in the order of the blocks.
[[nodiscard]] std::vector<LeafKey> leavesOf(const AttendedObject& object, const IorMap& map);

/// Box around leaves, in W, metres; empty for none.
[[nodiscard]] Eigen::AlignedBox3d boxOf(std::span<const LeafKey> leaves, double leaf_size_m);

}  // namespace saccade
