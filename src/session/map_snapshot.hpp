#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "saccade/pipeline/explorer.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_writer.hpp"

namespace saccade {

class SessionPager;

/// Copies of the parts of map, surface volume and attend log that changed, so that they can be compressed and written
/// while exploration goes on. To be recycled: fresh memory costs more than the copying.
class MapSnapshot {
 public:
  struct Part {
    BlobTable table;
    std::uint64_t key;
    std::uint64_t items;
    std::size_t begin, size;  // in the bytes
  };

  void clear();
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] std::string_view bytesOf(const Part& part) const;
  [[nodiscard]] const std::vector<std::uint64_t>& removedTiles() const { return removed_tiles_; }
  /// Forgets the parts and begins to touch memory for as much as they took and some more, so that the next filling need
  /// not: touchMore() does a little of it, and tells whether there is more to do.
  void beginRoom();
  [[nodiscard]] bool touchMore();
  /// Goes on in the room of `other`, which is emptied, if that has more.
  void takeRoomOf(MapSnapshot& other);

 private:
  friend class MapChanges;

  void add(BlobTable table, std::uint64_t key, std::uint64_t items, const void* data, std::size_t size);

  std::vector<std::byte> bytes_;
  std::size_t room_ = 0;  // bytes to touch
  std::vector<Part> parts_;
  std::vector<std::uint64_t> removed_tiles_;
};

/// Knows which parts of an exploration's map a session holds already, and finds those that changed since.
class MapChanges {
 public:
  /// Of a session without any part.
  MapChanges() = default;
  /// Of a session that holds everything that `explorer` has learnt.
  [[nodiscard]] static MapChanges noneIn(Explorer& explorer);
  /// Of a session of which `explorer` holds all but the map, which its pager brings.
  [[nodiscard]] static MapChanges noneIn(Explorer& explorer, const SessionReader& session);

  /// Adds to `snapshot` what changed since the last call. Tiles that are not in memory any more are removed from the
  /// session, unless `pager` has put them away. Cost: the changed parts, and a glance at each tile and brick.
  void take(Explorer& explorer, MapSnapshot& snapshot, const SessionPager* pager = nullptr);
  /// The part of it that can be had at once after each frame: the ticks of the attend log, which lets go of them.
  void takeTicks(Explorer& explorer, MapSnapshot& snapshot);
  /// Leaves of the map at the last call.
  [[nodiscard]] std::int64_t leaves() const;
  /// Leaves of a tile at the last call; none if it was not there.
  [[nodiscard]] std::optional<std::size_t> leavesOf(std::uint64_t tile_key) const;
  /// SurfaceVolume::changes() at the last call.
  [[nodiscard]] std::uint64_t surfaceChanges() const { return surface_changes_; }

 private:
  /// A tile that the session holds.
  struct Tile {
    std::uint64_t key;
    std::size_t leaves;
    friend auto operator<=>(const Tile&, const Tile&) = default;
  };

  [[nodiscard]] const Tile* find(std::uint64_t key) const;

  std::vector<Tile> tiles_;  // in rising order of their keys
  std::uint64_t surface_changes_ = 0;
  std::size_t ticks_ = 0;
};

}  // namespace saccade
