#include "saccade/objects/object_table.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <array>
#include <map>
#include <optional>

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
    const IorMap map = loadMap(session);
    const OrdinalByTick ordinals = ordinalsByTick(session);
    const std::vector<AttendedObject> objects = findObjects(session);
    database.requirePart(kObjects);
    db.exec("DELETE FROM objects; DELETE FROM object_looks");
    SQLite::Statement row(db, "INSERT INTO objects VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)");
    SQLite::Statement look_row(db, "INSERT INTO object_looks VALUES (?,?,?,?)");
    for (const AttendedObject& object : objects) {
      const std::vector<LeafKey> leaves = leavesOf(object, map);
      const ObjectLook& best = object.bestView();
      insert(row, object.id.value, object.looks.size(), object.looks.front().tick.value, object.looks.back().tick.value,
             ordinalAt(ordinals, best.tick), best.rank, leaves.size(),
             cornersOf(boxOf(leaves, map.config().leaf_size_m)));
      for (const ObjectLook& look : object.looks) {
        insert(look_row, object.id.value, look.tick.value, ordinalAt(ordinals, look.tick), look.rank);
      }
    }
    transaction.commit();
    return static_cast<int>(objects.size());
  });
}

}  // namespace saccade
