#include "session/map_snapshot.hpp"

#include <algorithm>
#include <iterator>

#include "saccade/map/map_tiles.hpp"
#include "session/map_blobs.hpp"

namespace saccade {

void MapSnapshot::clear() {
  bytes_.clear();
  parts_.clear();
  removed_tiles_.clear();
}

std::string_view MapSnapshot::bytesOf(const Part& part) const {
  return {reinterpret_cast<const char*>(bytes_.data()) + part.begin, part.size};
}

void MapSnapshot::makeRoom() {
  constexpr std::size_t kLeast = std::size_t{16} << 20U;
  const std::size_t used = bytes_.size();
  bytes_.resize(std::max(kLeast, used + used / 2));
  bytes_.resize(used);
}

void MapSnapshot::add(BlobTable table, std::uint64_t key, std::uint64_t items, const void* data, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(data);
  parts_.push_back({table, key, items, bytes_.size(), size});
  bytes_.insert(bytes_.end(), first, first + size);
}

MapChanges MapChanges::noneIn(Explorer& explorer) {
  MapChanges changes;
  for (const TileChange& tile : takeTileChanges(explorer.map())) changes.tiles_.push_back(tileKey(tile.root));
  std::sort(changes.tiles_.begin(), changes.tiles_.end());
  changes.surface_changes_ = explorer.surface().changes();
  changes.bricks_ = explorer.surface().bricks().size();
  changes.ticks_ = explorer.attendLog().tickCount();
  return changes;
}

void MapChanges::take(Explorer& explorer, MapSnapshot& snapshot) {
  snapshot.clear();
  std::vector<std::uint64_t> tiles;
  for (const TileChange& tile : takeTileChanges(explorer.map())) {
    const std::uint64_t key = tileKey(tile.root);
    tiles.push_back(key);
    if (!tile.changed && std::binary_search(tiles_.begin(), tiles_.end(), key)) continue;
    const std::size_t begin = snapshot.bytes_.size();
    appendTile(tile.node, snapshot.bytes_);
    snapshot.parts_.push_back({BlobTable::kTiles, key, 1, begin, snapshot.bytes_.size() - begin});
  }
  std::sort(tiles.begin(), tiles.end());
  std::set_difference(tiles_.begin(), tiles_.end(), tiles.begin(), tiles.end(),
                      std::back_inserter(snapshot.removed_tiles_));
  tiles_ = std::move(tiles);

  const SurfaceVolume& surface = explorer.surface();
  for (std::size_t i = 0; i < surface.bricks().size(); ++i) {
    if (i < bricks_ && surface.lastChange(i) <= surface_changes_) continue;
    const SurfaceBrick& brick = surface.brick(i);
    static_assert(sizeof brick == sizeof brick.distance + sizeof brick.weight, "a brick's bytes are its samples");
    snapshot.add(BlobTable::kBricks, brickKey(surface.bricks()[i]), 1, &brick, sizeof brick);
  }
  surface_changes_ = surface.changes();
  bricks_ = surface.bricks().size();

  const AttendLog& log = explorer.attendLog();
  for (; ticks_ < log.tickCount(); ++ticks_) {
    const std::string bytes = encodeTick(log, ticks_);
    snapshot.add(BlobTable::kAttendLog, log.tick(ticks_).tick.value, log.candidateCount(ticks_), bytes.data(),
                 bytes.size());
  }
}

}  // namespace saccade
