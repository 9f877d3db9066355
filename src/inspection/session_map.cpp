#include "saccade/inspection/session_map.hpp"

#include "saccade/core/config_file.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "session/map_blobs.hpp"

namespace saccade {

IorMap loadMap(const SessionReader& session, const std::filesystem::path& path) {
  ExplorerConfig config;
  applyConfigText(session.metadata().config_yaml, path, describing(config));
  std::vector<MapTile> tiles;
  session.visitBlobs(BlobTable::kTiles, [&](const BlobRecord& blob) {
    const auto* bytes = reinterpret_cast<const std::byte*>(blob.bytes.data());
    tiles.push_back({tileRoot(blob.key), {bytes, bytes + blob.bytes.size()}});
  });
  return restoreMap(config.map, tiles, Tick{session.metadata().tick}, path);
}

}  // namespace saccade
