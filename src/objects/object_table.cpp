#include "saccade/objects/object_table.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "saccade/map/morton_code.hpp"
#include "saccade/objects/object_memory.hpp"
#include "saccade/session/session_map.hpp"
#include "session/row.hpp"
#include "session/session_database.hpp"

namespace saccade {
namespace {

constexpr SessionPart kObjects = {"objects", 1, R"sql(
CREATE TABLE objects (           -- candidates that returned on the same leaves, found in the attend log
  id INTEGER PRIMARY KEY,        -- from 1, in the order of first sight
  times_seen INTEGER NOT NULL,   -- ticks in which it was looked at
  first_tick INTEGER NOT NULL,
  last_tick INTEGER NOT NULL,
  best_ordinal INTEGER,          -- frame that saw most of it
  best_rank INTEGER NOT NULL,    -- and the candidate there
  leaves INTEGER NOT NULL,       -- occupied when this was written
  min_x REAL, min_y REAL, min_z REAL, max_x REAL, max_y REAL, max_z REAL);  -- in W, metres; NULL when it is gone
CREATE TABLE object_looks (
  object INTEGER NOT NULL, tick INTEGER NOT NULL, ordinal INTEGER, rank INTEGER NOT NULL,
  PRIMARY KEY (object, tick)) WITHOUT ROWID;
)sql"};

using OrdinalByTick = std::map<std::uint32_t, std::int64_t>;

OrdinalByTick ordinalsByTick(const SessionReader& session) {
  OrdinalByTick ordinals;
  for (const FrameRecord& frame : session.frames()) {
    if (frame.tracking != "lost" && frame.tick > 0) ordinals.emplace(frame.tick - 1, frame.ordinal.value);
  }
  return ordinals;
}

std::optional<std::int64_t> ordinalAt(const OrdinalByTick& ordinals, Tick tick) {
  const auto found = ordinals.find(tick.value);
  return found == ordinals.end() ? std::nullopt : std::optional(found->second);
}

/// What the map shows of an object now.
struct Extent {
  std::size_t leaves = 0;  ///< occupied ones
  Eigen::AlignedBox3d box_W;
};

/// The extents of the objects, found tile by tile: an exploration that keeps its map small ends with this, and must not
/// have the whole map in memory for it.
std::vector<Extent> extentsOf(const std::vector<AttendedObject>& objects, const SessionReader& session) {
  struct Part {
    std::uint64_t code;  // of the block's first leaf
    std::uint32_t object;
    bool operator<(const Part& other) const { return code < other.code; }
  };
  std::vector<Part> parts;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (const LeafBlock& block : objects[i].blocks) {
      parts.push_back({mortonCode(leavesOf(block).front()), static_cast<std::uint32_t>(i)});
    }
  }
  std::sort(parts.begin(), parts.end());
  std::vector<Extent> extents(objects.size());
  visitMapTiles(session, [&](const NodeKey& root, const IorMap& tile) {
    const std::uint64_t first = mortonCode(root.corner), count = std::uint64_t{1} << 3 * (MapTree::kDepth - root.depth);
    for (auto part = std::lower_bound(parts.begin(), parts.end(), Part{first, 0});
         part != parts.end() && part->code - first < count; ++part) {
      Extent& extent = extents[part->object];
      for (const LeafKey& key : leavesOf(blockOf(keyOfMortonCode(part->code)))) {
        const auto leaf = tile.findLeaf(key);
        if (!leaf || !leaf->occupied) continue;
        ++extent.leaves;
        extent.box_W.extend(boxOf({&key, 1}, tile.config().leaf_size_m));
      }
    }
  });
  return extents;
}

std::array<std::optional<double>, 6> cornersOf(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return {};
  return {box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()};
}

}  // namespace

int storeObjects(const std::filesystem::path& path) {
  SessionDatabase database(path, SessionDatabase::Access::kWrite);
  return database.use("a session that nobody else writes to", [&] {
    SQLite::Database& db = database.sqlite();
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    const SessionReader session(path);
    const OrdinalByTick ordinals = ordinalsByTick(session);
    const std::vector<AttendedObject> objects = findObjects(session);
    const std::vector<Extent> extents = extentsOf(objects, session);
    database.requirePart(kObjects);
    db.exec("DELETE FROM objects; DELETE FROM object_looks");
    SQLite::Statement row(db, "INSERT INTO objects VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)");
    SQLite::Statement look_row(db, "INSERT INTO object_looks VALUES (?,?,?,?)");
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const AttendedObject& object = objects[i];
      const ObjectLook& best = object.bestView();
      insert(row, object.id.value, object.looks.size(), object.looks.front().tick.value, object.looks.back().tick.value,
             ordinalAt(ordinals, best.tick), best.rank, extents[i].leaves, cornersOf(extents[i].box_W));
      for (const ObjectLook& look : object.looks) {
        insert(look_row, object.id.value, look.tick.value, ordinalAt(ordinals, look.tick), look.rank);
      }
    }
    transaction.commit();
    return static_cast<int>(objects.size());
  });
}

}  // namespace saccade
