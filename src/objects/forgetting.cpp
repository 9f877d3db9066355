#include "saccade/objects/forgetting.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "saccade/map/ior_octree.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/session/session_map.hpp"
#include "session/blob_codec.hpp"
#include "session/map_blobs.hpp"
#include "session/row.hpp"
#include "session/session_database.hpp"

namespace saccade {
namespace {

constexpr SessionPart kForgettings = {"forgettings", 1, R"sql(
CREATE TABLE forgettings (       -- attention memory that was cleared by hand
  number INTEGER PRIMARY KEY,
  tick INTEGER NOT NULL,         -- of the session when it was done
  utc TEXT NOT NULL,
  what TEXT NOT NULL,            -- everything, a box, an object
  leaves INTEGER NOT NULL);      -- that remembered anything
)sql"};

Eigen::Vector3d centreOf(const NodeKey& key, double leaf_size_m) {
  const double half = 0.5 * static_cast<double>(1 << (MapTree::kDepth - key.depth));
  const Eigen::Vector3d corner(key.corner.x - MapTree::kCentreKey, key.corner.y - MapTree::kCentreKey,
                               key.corner.z - MapTree::kCentreKey);
  return (corner + Eigen::Vector3d::Constant(half)) * leaf_size_m;
}

/// The tile that holds the node.
NodeKey tileOf(const NodeKey& node) {
  if (node.depth <= kTileDepth) return node;
  const auto mask = static_cast<std::uint16_t>(~((1u << (MapTree::kDepth - kTileDepth)) - 1u));
  const auto cut = [&](std::uint16_t part) { return static_cast<std::uint16_t>(part & mask); };
  return {{cut(node.corner.x), cut(node.corner.y), cut(node.corner.z)}, kTileDepth};
}

void replaceTile(SQLite::Database& db, const IorMap& map, const NodeKey& root, const std::filesystem::path& path) {
  const PackedBlob packed = packBlob(bytesOf(encodeTile(map, root)));
  SQLite::Statement row(db, "UPDATE tiles SET crc32c = ?, size = ?, data = ? WHERE key = ?");
  insert(row, packed.crc32c, packed.unpacked_size, Bytes{packed.bytes}, tileKey(root));
  if (row.getChanges() != 1) throw IoError(path, "the tile that was read before", "none");
}

}  // namespace

ForgetSelection ForgetSelection::everything() {
  return {[](const MapLeaf&, double) { return true; }, "everything"};
}

ForgetSelection ForgetSelection::box(const Eigen::AlignedBox3d& box_W) {
  const auto contains = [box_W](const MapLeaf& leaf, double leaf_size_m) {
    return box_W.contains(centreOf(leaf.key, leaf_size_m));
  };
  const Eigen::Vector3d &low = box_W.min(), &high = box_W.max();
  return {contains, fmt::format("box {} {} {} to {} {} {}", low.x(), low.y(), low.z(), high.x(), high.y(), high.z())};
}

ForgetSelection ForgetSelection::object(const AttendedObject& object) {
  const auto contains = [blocks = object.blocks](const MapLeaf& leaf, double) {
    const LeafKey& corner = leaf.key.corner;
    const int edge = 1 << (MapTree::kDepth - leaf.key.depth) >> 1;  // in blocks; 0 for the finest leaves
    if (edge <= 1) return std::binary_search(blocks.begin(), blocks.end(), blockOf(corner));
    return std::any_of(blocks.begin(), blocks.end(), [&](const LeafBlock& block) {
      const LeafKey half = LeafKey::fromPacked(block.packed);
      const auto within = [&](std::uint16_t part, std::uint16_t from) {
        return part >= from >> 1 && part < (from >> 1) + edge;
      };
      return within(half.x, corner.x) && within(half.y, corner.y) && within(half.z, corner.z);
    });
  };
  return {contains, fmt::format("object {}", object.id.value)};
}

std::vector<NodeKey> forgetAttention(IorMap& map, const ForgetSelection& selection) {
  std::vector<NodeKey> forgotten;
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (!wasAttended(leaf.ior) || !selection.contains(leaf, map.config().leaf_size_m)) return;
    forgotten.push_back(leaf.key);
  });
  IorOcTree& tree = map.tree();
  for (const NodeKey& key : forgotten) {
    tree.search(octomap::OcTreeKey(key.corner.x, key.corner.y, key.corner.z))->setIor({});
  }
  tree.updateInnerNodes();
  return forgotten;
}

ForgettingRecord forgetInSession(const std::filesystem::path& path, const ForgetSelection& selection,
                                 const std::string& utc) {
  SessionDatabase database(path, SessionDatabase::Access::kWrite);
  return database.use("a session that nobody else writes to", [&] {
    SQLite::Database& db = database.sqlite();
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    const SessionReader session(path);
    IorMap map = loadMap(session);
    const std::vector<NodeKey> forgotten = forgetAttention(map, selection);
    std::vector<NodeKey> tiles;
    for (const NodeKey& key : forgotten) tiles.push_back(tileOf(key));
    std::sort(tiles.begin(), tiles.end());
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    for (const NodeKey& tile : tiles) replaceTile(db, map, tile, path);

    const ForgettingRecord record{map.now(), utc, selection.description(), static_cast<std::int64_t>(forgotten.size())};
    database.requirePart(kForgettings);
    SQLite::Statement row(db, "INSERT INTO forgettings (tick, utc, what, leaves) VALUES (?, ?, ?, ?)");
    insert(row, record.tick.value, record.when, record.what, record.leaves);
    transaction.commit();
    return record;
  });
}

std::vector<ForgettingRecord> listForgettings(const SessionReader& session) {
  const SessionDatabase& database = session.database();
  std::vector<ForgettingRecord> records;
  if (!database.hasPart(kForgettings)) return records;
  database.use("a whole Saccade session", [&] {
    SQLite::Statement query(database.sqlite(), "SELECT tick, utc, what, leaves FROM forgettings ORDER BY number");
    while (query.executeStep()) {
      RowReader row(query);
      ForgettingRecord record;
      record.tick = {static_cast<std::uint32_t>(row.integer())};
      record.when = row.text();
      record.what = row.text();
      record.leaves = row.integer();
      records.push_back(std::move(record));
    }
  });
  return records;
}

}  // namespace saccade
