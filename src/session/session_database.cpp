#include "session/session_database.hpp"

#include <array>
#include <sqlite3.h>
#include <system_error>

#include "session/schema.hpp"

namespace saccade {
namespace {

constexpr int kBusyTimeout_ms = 10'000;  // another connection's commit takes far less

/// No value of a session is larger; a forged one cannot make SQLite ask for more.
constexpr int kLargestValue = 256 << 20;

int flagsOf(SessionDatabase::Access access) {
  switch (access) {
    case SessionDatabase::Access::kRead:
      return SQLite::OPEN_READONLY;
    case SessionDatabase::Access::kWrite:
      return SQLite::OPEN_READWRITE;
    case SessionDatabase::Access::kCreate:
      return SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE;
  }
  return 0;
}

int touch(const std::filesystem::path& path, int flags) {
  return SQLite::Database(path.string(), flags, kBusyTimeout_ms).tryExec("SELECT count(*) FROM sqlite_schema");
}

/// A writer that was killed while it changed the journal mode leaves a page to be put back, which a read-only
/// connection may not do.
void finishInterrupted(const std::filesystem::path& path) {
  if (touch(path, SQLite::OPEN_READONLY) == SQLITE_READONLY) (void)touch(path, SQLite::OPEN_READWRITE);
}

SQLite::Database openSqlite(const std::filesystem::path& path, SessionDatabase::Access access) {
  std::error_code ignored;
  if (access != SessionDatabase::Access::kCreate && !std::filesystem::is_regular_file(path, ignored)) {
    throw IoError(path, "a session file", std::filesystem::exists(path, ignored) ? "a folder or device" : "nothing");
  }
  try {
    if (access == SessionDatabase::Access::kRead) finishInterrupted(path);
    return SQLite::Database(path.string(), flagsOf(access), kBusyTimeout_ms);
  } catch (const SQLite::Exception& error) {
    throw IoError(path, "a session file that can be opened", error.what());
  }
}

int pragma(SQLite::Database& db, const char* name) {
  return db.execAndGet(std::string("PRAGMA ") + name).getInt();
}

}  // namespace

std::string SessionDatabase::complaint(const SQLite::Exception& error) {
  switch (error.getErrorCode()) {
    case SQLITE_FULL:
      return "a full disk";
    case SQLITE_READONLY:
      return "a read-only place";
    case SQLITE_CANTOPEN:
      return "a file that cannot be created";
    case SQLITE_BUSY:
      return "one that another program keeps locked";
    default:
      return error.what();
  }
}

SessionDatabase::SessionDatabase(const std::filesystem::path& path, Access access)
    : path_(path), db_(openSqlite(path, access)) {
  sqlite3_limit(db_.getHandle(), SQLITE_LIMIT_LENGTH, kLargestValue);
  access == Access::kCreate ? create() : open(access);
}

void SessionDatabase::create() {
  use("a session file that can be written", [&] {
    // A file that does not have its name yet is worthless after a crash whatever its state: it needs no journal.
    db_.exec("PRAGMA journal_mode = OFF");
    db_.exec("PRAGMA synchronous = OFF");
    db_.exec("PRAGMA application_id = " + std::to_string(schema::kApplicationId));
    db_.exec("PRAGMA user_version = " + std::to_string(schema::kFormatVersion));
    db_.exec(schema::kTables);
    db_.exec(schema::kStateTable);
    format_version_ = schema::kFormatVersion;
  });
}

void SessionDatabase::open(Access access) {
  use("a whole Saccade session", [&] {
    db_.exec("PRAGMA trusted_schema = OFF");
    db_.exec("PRAGMA cell_size_check = ON");
    if (pragma(db_, "application_id") != schema::kApplicationId) {
      throw IoError(path_, "a Saccade session", "an SQLite database of another program");
    }
    format_version_ = pragma(db_, "user_version");
  });
  const int oldest = access == Access::kRead ? 1 : schema::kFormatVersion;
  if (format_version_ < oldest || format_version_ > schema::kFormatVersion) {
    throw IoError(
        path_,
        "a session of format version " + std::to_string(oldest) + " to " + std::to_string(schema::kFormatVersion),
        "version " + std::to_string(format_version_) +
            (format_version_ > schema::kFormatVersion ? " (a newer Saccade wrote it)"
                                                      : " (saccade repair updates it)"));
  }
  use("a whole Saccade session", [&] {
    // A view or virtual table under a table's name could compute anything, for ever.
    const int foreign = db_.execAndGet(
                               "SELECT count(*) FROM main.sqlite_schema WHERE type NOT IN ('table', 'index') OR "
                               "sql LIKE 'CREATE VIRTUAL%' OR sql LIKE '%GENERATED ALWAYS%'")
                            .getInt();
    if (foreign != 0) throw IoError(path_, "only tables in a session", "views, triggers or computed tables");
    if (format_version_ == 1) db_.exec(schema::kViewsOfVersion1);
    if (!db_.tableExists("state")) {
      db_.exec(access == Access::kRead ? schema::kViewOfNoState : schema::kStateTable);
    }
  });
}

bool SessionDatabase::hasPart(const SessionPart& part) const {
  return use("a whole Saccade session", [&] {
    SQLite::Statement query(db_, "SELECT version FROM parts WHERE name = ?");
    query.bind(1, part.name);
    if (!query.executeStep()) return false;
    const int version = query.getColumn(0).getInt();
    if (version < 1 || version > part.version) {
      throw IoError(path_, std::string(part.name) + " of version 1 to " + std::to_string(part.version),
                    "version " + std::to_string(version) + " (a newer Saccade wrote it)");
    }
    return true;
  });
}

void SessionDatabase::requirePart(const SessionPart& part) {
  if (hasPart(part)) return;
  use(std::string("room for ") + part.name, [&] {
    db_.exec(part.tables);
    SQLite::Statement row(db_, "INSERT INTO parts VALUES (?, ?)");
    row.bind(1, part.name);
    row.bind(2, part.version);
    row.exec();
  });
}

}  // namespace saccade
