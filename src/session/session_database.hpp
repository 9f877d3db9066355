#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "saccade/core/errors.hpp"

namespace saccade {

/// A group of tables that a stage keeps in sessions beside those of schema.hpp, with a version of its own: how a
/// session learns something new without a new format.
///
/// A stage declares one constant of this type in a header of its own, calls SessionDatabase::requirePart() before it
/// writes, and SessionDatabase::hasPart() before it reads. Sessions without the part stay readable, programs that do
/// not know it leave it alone, and one that knows only an older version of it refuses that part and nothing else.
/// Raise `version` when the tables or what is in them change their meaning.
struct SessionPart {
  const char* name;    ///< unique; also the name of its table, or what its tables' names begin with
  int version;         ///< from 1
  const char* tables;  ///< CREATE TABLE statements
};

/// An open session file: the one place that opens SQLite on a session, sets it up, and turns what it throws into
/// IoErrors. Not thread-safe.
class SessionDatabase {
 public:
  enum class Access {
    kRead,    ///< an existing session, nothing is changed
    kWrite,   ///< an existing session of the current format
    kCreate,  ///< a new file with empty tables, not safe against crashes; none may be there
  };

  /// Throws IoError for whatever is not a session of a format version that `access` allows.
  SessionDatabase(const std::filesystem::path& path, Access access);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] int formatVersion() const { return format_version_; }
  [[nodiscard]] SQLite::Database& sqlite() const { return db_; }

  /// Whether the session has the part. Throws IoError if it has a newer version than `part.version`.
  [[nodiscard]] bool hasPart(const SessionPart& part) const;
  /// Makes the tables of the part unless they are there. Throws IoError as hasPart().
  void requirePart(const SessionPart& part);

  /// Runs `use` and turns what SQLite throws into an IoError that says that `expected` was.
  template <typename Use>
  auto use(const std::string& expected, const Use& use) const {
    try {
      return use();
    } catch (const SQLite::Exception& error) {
      throw IoError(path_, expected, complaint(error));
    }
  }

 private:
  static std::string complaint(const SQLite::Exception& error);
  void create();
  void open(Access access);

  std::filesystem::path path_;
  mutable SQLite::Database db_;
  int format_version_ = 0;
};

}  // namespace saccade
