#include "saccade/exchange/map_session.hpp"

#include "saccade/core/config_file.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/version.hpp"
#include "session/map_blobs.hpp"

namespace saccade {

void writeMapSession(const IorMap& map, ExplorerConfig config, const MapOrigin& origin,
                     const std::filesystem::path& path, WhenSessionExists when_exists) {
  SessionWriter writer(path, when_exists);
  writer.addRun({0, {}, origin.input, origin.input_kind, origin.created_utc, kVersion});
  for (const NodeKey& root : listTiles(map)) {
    writer.putBlob(BlobTable::kTiles, {tileKey(root), 1, bytesOf(encodeTile(map, root))});
  }
  SessionMetadata metadata;
  metadata.saccade_version = kVersion;
  metadata.created_utc = origin.created_utc;
  metadata.input = origin.input;
  metadata.input_kind = origin.input_kind;
  metadata.config_yaml = printConfig(describing(config), false);
  metadata.leaf_size_m = map.config().leaf_size_m;
  metadata.tick = map.now().value;
  metadata.leaves = static_cast<std::int64_t>(map.leafCount());
  writer.finish(metadata);
}

}  // namespace saccade
