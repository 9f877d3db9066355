#include "session/map_snapshot.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "saccade/map/map_tiles.hpp"
#include "session/map_blobs.hpp"
#include "session/session_pager.hpp"

namespace saccade {

void MapSnapshot::clear() {
  bytes_.clear();
  parts_.clear();
  removed_tiles_.clear();
}

std::string_view MapSnapshot::bytesOf(const Part& part) const {
  return {reinterpret_cast<const char*>(bytes_.data()) + part.begin, part.size};
}

void MapSnapshot::beginRoom() {
  constexpr std::size_t kLeast = std::size_t{32} << 20U;
  room_ = std::max(kLeast, bytes_.size() + bytes_.size() / 2);
  clear();
  bytes_.reserve(room_);
}

bool MapSnapshot::touchMore() {
  constexpr std::size_t kStep = std::size_t{1} << 20U;
  bytes_.resize(std::min(room_, bytes_.size() + kStep));
  if (bytes_.size() < room_) return true;
  bytes_.clear();
  return false;
}

void MapSnapshot::takeRoomOf(MapSnapshot& other) {
  other.clear();
  if (other.bytes_.capacity() <= bytes_.capacity()) return;
  other.bytes_.insert(other.bytes_.end(), bytes_.begin(), bytes_.end());
  bytes_.swap(other.bytes_);
  other.clear();
}

void MapSnapshot::add(BlobTable table, std::uint64_t key, std::uint64_t items, const void* data, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(data);
  parts_.push_back({table, key, items, bytes_.size(), size});
  bytes_.insert(bytes_.end(), first, first + size);
}

MapChanges MapChanges::noneIn(Explorer& explorer) {
  MapChanges changes;
  std::vector<std::byte> bytes;
  for (const TileChange& tile : takeTileChanges(explorer.map())) {
    bytes.clear();
    changes.tiles_.push_back({tileKey(tile.root), appendTile(tile.node, bytes)});
  }
  std::sort(changes.tiles_.begin(), changes.tiles_.end());
  changes.surface_changes_ = std::as_const(explorer).surface().changes();
  changes.ticks_ = explorer.attendLog().tickCount();
  return changes;
}

MapChanges MapChanges::noneIn(Explorer& explorer, const SessionReader& session) {
  MapChanges changes;
  for (const BlobKey& tile : session.blobKeys(BlobTable::kTiles)) {
    changes.tiles_.push_back({tile.key, static_cast<std::size_t>(tile.items)});
  }
  changes.ticks_ = explorer.attendLog().tickCount();
  return changes;
}

const MapChanges::Tile* MapChanges::find(std::uint64_t key) const {
  const auto at = std::lower_bound(tiles_.begin(), tiles_.end(), Tile{key, 0});
  return at != tiles_.end() && at->key == key ? &*at : nullptr;
}

std::int64_t MapChanges::leaves() const {
  return std::accumulate(tiles_.begin(), tiles_.end(), std::int64_t{0}, [](std::int64_t sum, const Tile& tile) {
    return sum + static_cast<std::int64_t>(tile.leaves);
  });
}

std::optional<std::size_t> MapChanges::leavesOf(std::uint64_t tile_key) const {
  const Tile* tile = find(tile_key);
  return tile != nullptr ? std::optional(tile->leaves) : std::nullopt;
}

void MapChanges::take(Explorer& explorer, MapSnapshot& snapshot, const SessionPager* pager) {
  std::vector<Tile> tiles;
  for (const TileChange& change : takeTileChanges(explorer.map())) {
    const std::uint64_t key = tileKey(change.root);
    const Tile* known = find(key);
    if (!change.changed && known != nullptr) {
      tiles.push_back(*known);
      continue;
    }
    const std::size_t begin = snapshot.bytes_.size();
    tiles.push_back({key, appendTile(change.node, snapshot.bytes_)});
    snapshot.parts_.push_back({BlobTable::kTiles, key, tiles.back().leaves, begin, snapshot.bytes_.size() - begin});
  }
  for (const Tile& known : tiles_) {
    if (pager != nullptr && pager->isAway(known.key)) tiles.push_back(known);
  }
  std::sort(tiles.begin(), tiles.end());
  std::swap(tiles, tiles_);
  for (const Tile& old : tiles) {
    if (find(old.key) == nullptr) snapshot.removed_tiles_.push_back(old.key);
  }

  const SurfaceVolume& surface = std::as_const(explorer).surface();
  for (std::size_t i = 0; i < surface.bricks().size(); ++i) {
    if (surface.lastChange(i) <= surface_changes_) continue;
    const SurfaceBrick& brick = surface.brick(i);
    static_assert(sizeof brick == sizeof brick.distance + sizeof brick.weight, "a brick's bytes are its samples");
    snapshot.add(BlobTable::kBricks, brickKey(surface.bricks()[i]), 1, &brick, sizeof brick);
  }
  surface_changes_ = surface.changes();

  takeTicks(explorer, snapshot);
}

void MapChanges::takeTicks(Explorer& explorer, MapSnapshot& snapshot) {
  AttendLog& log = explorer.attendLog();
  for (; ticks_ < log.tickCount(); ++ticks_) {
    const std::string bytes = encodeTick(log, ticks_);
    snapshot.add(BlobTable::kAttendLog, log.tick(ticks_).tick.value, log.candidateCount(ticks_), bytes.data(),
                 bytes.size());
  }
  log.letGo(ticks_);
}

}  // namespace saccade
