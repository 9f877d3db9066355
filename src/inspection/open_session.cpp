#include "inspection/open_session.hpp"

#include "session/map_blobs.hpp"
#include "session/session_database.hpp"

namespace saccade {
namespace {

constexpr const char* kWholeSession = "a whole Saccade session";

}  // namespace

OpenSession::OpenSession(const std::filesystem::path& path)
    : reader(path), config(loadConfig(reader)), frames(reader.frames()), data_version_(dataVersion()) {
  for (const BlobKey& blob : reader.blobKeys(BlobTable::kTiles)) roots.push_back(tileRoot(blob.key));
  reader.database().use(kWholeSession, [&] {
    SQLite::Statement query(reader.database().sqlite(),
                            "SELECT ordinal FROM keyframes WHERE length(color) > 0 ORDER BY ordinal");
    while (query.executeStep()) keyframe_ordinals.push_back(query.getColumn(0).getInt64());
  });
}

IorMap OpenSession::loadTile(const NodeKey& root) const {
  std::vector<MapTile> tiles;
  if (const auto blob = reader.blob(BlobTable::kTiles, tileKey(root))) {
    const auto* bytes = reinterpret_cast<const std::byte*>(blob->bytes.data());
    tiles.push_back({root, {bytes, bytes + blob->bytes.size()}});
  }
  return restoreMap(config.map, tiles, Tick{reader.metadata().tick}, reader.path());
}

std::vector<std::uint32_t> OpenSession::tileChecksums() const {
  std::vector<std::uint32_t> checksums;
  reader.database().use(kWholeSession, [&] {
    SQLite::Statement query(reader.database().sqlite(), "SELECT crc32c FROM tiles ORDER BY key");
    while (query.executeStep()) checksums.push_back(query.getColumn(0).getUInt());
  });
  return checksums;
}

std::vector<double> OpenSession::revisitRates() const {
  std::vector<double> rates(frames.size(), 0.0);
  reader.database().use(kWholeSession, [&] {
    SQLite::Statement query(reader.database().sqlite(),
                            "SELECT ordinal, avg(revisited_share >= 0.5) FROM candidates GROUP BY ordinal");
    while (query.executeStep()) {
      const auto ordinal = static_cast<std::size_t>(query.getColumn(0).getInt64());
      if (ordinal < rates.size()) rates[ordinal] = query.getColumn(1).getDouble();
    }
  });
  return rates;
}

bool OpenSession::changed() {
  const std::int64_t before = data_version_;
  data_version_ = dataVersion();
  return data_version_ != before;
}

std::int64_t OpenSession::dataVersion() const {
  return reader.database().use(kWholeSession,
                               [&] { return reader.database().sqlite().execAndGet("PRAGMA data_version").getInt64(); });
}

}  // namespace saccade
