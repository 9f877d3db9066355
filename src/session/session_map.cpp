#include "saccade/session/session_map.hpp"

#include <vector>

#include "saccade/core/config_file.hpp"
#include "saccade/map/map_tiles.hpp"
#include "session/map_blobs.hpp"

namespace saccade {

ExplorerConfig loadConfig(const SessionReader& session) {
  ExplorerConfig config;
  applyConfigText(session.metadata().config_yaml, session.path(), describing(config));
  return config;
}

IorMap loadMap(const SessionReader& session) {
  std::vector<MapTile> tiles;
  session.visitBlobs(BlobTable::kTiles, [&](const BlobRecord& blob) {
    const auto* bytes = reinterpret_cast<const std::byte*>(blob.bytes.data());
    tiles.push_back({tileRoot(blob.key), {bytes, bytes + blob.bytes.size()}});
  });
  return restoreMap(loadConfig(session).map, tiles, {session.metadata().tick}, session.path());
}

}  // namespace saccade
