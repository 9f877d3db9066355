#include "saccade/session/session_writer.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sqlite3.h>
#include <system_error>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "saccade/core/errors.hpp"
#include "session/blob_codec.hpp"
#include "session/blob_table_name.hpp"
#include "session/metadata_json.hpp"
#include "session/schema.hpp"

namespace saccade {
namespace {

/// What SQLite says, in the words of someone who wants to know what to do.
std::string found(const SQLite::Exception& error) {
  switch (error.getErrorCode()) {
    case SQLITE_FULL:
      return "a full disk";
    case SQLITE_READONLY:
      return "a read-only place";
    case SQLITE_CANTOPEN:
      return "a file that cannot be created";
    default:
      return error.what();
  }
}

void makeDurable(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw IoError(path, "a file that can be opened", std::strerror(errno));
  const int synced = ::fsync(file);
  const int reason = errno;
  ::close(file);
  if (synced != 0) throw IoError(path, "data that reach the disk", std::strerror(reason));
}

std::filesystem::path folderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

}  // namespace

struct SessionWriter::Database {
  explicit Database(const std::filesystem::path& path)
      : db(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {}

  SQLite::Database db;
  std::unique_ptr<SQLite::Statement> frame, candidate;
  std::int64_t next_ordinal = 0;
};

SessionWriter::SessionWriter(const std::filesystem::path& path, WhenSessionExists when_exists)
    : path_(path), partial_(path.string() + ".partial") {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored)) throw IoError(path_, "a file name for the session", "a folder");
  if (when_exists == WhenSessionExists::kRefuse && std::filesystem::exists(path_, ignored)) {
    throw IoError(path_, "no session of that name (--force replaces it)", "one that exists");
  }
  if (!std::filesystem::is_directory(folderOf(path_), ignored)) {
    throw IoError(folderOf(path_), "a folder to write the session to", "none");
  }
  std::filesystem::remove(partial_, ignored);
  try {
    database_ = std::make_unique<Database>(partial_);
    SQLite::Database& db = database_->db;
    // The partial file is worthless after a crash whatever its state, so it needs no journal; finish() syncs it once.
    db.exec("PRAGMA journal_mode = OFF");
    db.exec("PRAGMA synchronous = OFF");
    db.exec("PRAGMA application_id = " + std::to_string(schema::kApplicationId));
    db.exec("PRAGMA user_version = " + std::to_string(schema::kFormatVersion));
    db.exec(schema::kTables);
    db.exec("BEGIN");
    database_->frame =
        std::make_unique<SQLite::Statement>(db, "INSERT INTO frames VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    database_->candidate =
        std::make_unique<SQLite::Statement>(db, "INSERT INTO candidates VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  } catch (const SQLite::Exception& error) {
    throw IoError(path_, "a session file that can be written", found(error));
  }
}

SessionWriter::~SessionWriter() {
  if (!database_) return;  // finished
  database_.reset();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void SessionWriter::addFrame(const FrameRecord& frame) try {
  SQLite::Statement& row = *database_->frame;
  int column = 0;
  const auto bind = [&](const auto& value) { row.bind(++column, value); };
  bind(database_->next_ordinal++);
  bind(frame.index.value);
  bind(frame.name);
  bind(frame.stamp_s);
  bind(frame.tracking);
  if (frame.T_WC) {
    const Eigen::Vector3d t = frame.T_WC->translation();
    const Eigen::Quaterniond q(frame.T_WC->rotation());
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) bind(value);
  } else {
    for (int i = 0; i < 7; ++i) row.bind(++column);  // NULL
  }
  bind(frame.inlier_share);
  bind(frame.rms_m);
  bind(frame.tick);
  bind(frame.open);
  bind(frame.inhibited);
  bind(frame.attended);
  bind(frame.processing_ms);
  row.exec();
  row.reset();
} catch (const SQLite::Exception& error) {
  throw IoError(path_, "room for another frame", found(error));
}

void SessionWriter::addCandidate(const CandidateRecord& candidate) try {
  SQLite::Statement& row = *database_->candidate;
  int column = 0;
  const auto bind = [&](const auto& value) { row.bind(++column, value); };
  bind(candidate.frame.value);
  bind(candidate.rank);
  bind(candidate.score);
  bind(candidate.source);
  for (const int value : {candidate.box.x, candidate.box.y, candidate.box.width, candidate.box.height}) bind(value);
  for (const double value : candidate.box3d_m) bind(value);
  bind(candidate.mask_rle);
  bind(nlohmann::json(candidate.features).dump());
  bind(candidate.revisited_share);
  row.exec();
  row.reset();
} catch (const SQLite::Exception& error) {
  throw IoError(path_, "room for another candidate", found(error));
}

void SessionWriter::addBlob(BlobTable table, const BlobRecord& blob) try {
  const PackedBlob packed = packBlob(blob.bytes);
  SQLite::Statement row(database_->db, std::string("INSERT INTO ") + nameOf(table) + " VALUES (?,?,?,?,?)");
  row.bind(1, static_cast<std::int64_t>(blob.key));
  row.bind(2, static_cast<std::int64_t>(blob.items));
  row.bind(3, packed.crc32c);
  row.bind(4, static_cast<std::int64_t>(packed.unpacked_size));
  row.bindNoCopy(5, packed.bytes.data(), static_cast<int>(packed.bytes.size()));
  row.exec();
} catch (const SQLite::Exception& error) {
  throw IoError(path_, "room for the map", found(error));
}

void SessionWriter::finish(const SessionMetadata& metadata) {
  try {
    SQLite::Statement row(database_->db, "INSERT INTO meta VALUES (?,?)");
    for (const auto& [key, value] : metadataToText(metadata)) {
      row.bind(1, key);
      row.bind(2, value);
      row.exec();
      row.reset();
    }
    database_->frame.reset();
    database_->candidate.reset();
    database_->db.exec("COMMIT");
  } catch (const SQLite::Exception& error) {
    throw IoError(path_, "room for the session", found(error));
  }
  database_.reset();
  std::error_code failure;
  try {
    makeDurable(partial_);
    std::filesystem::rename(partial_, path_, failure);
    if (failure) throw IoError(path_, "a session that can be given its name", failure.message());
  } catch (const IoError&) {
    std::filesystem::remove(partial_, failure);
    throw;
  }
  makeDurable(folderOf(path_));
}

}  // namespace saccade
