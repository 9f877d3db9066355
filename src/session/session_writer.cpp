#include "saccade/session/session_writer.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <system_error>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "saccade/core/errors.hpp"
#include "session/blob_codec.hpp"
#include "session/blob_table_name.hpp"
#include "session/keyframe_images.hpp"
#include "session/metadata_json.hpp"
#include "session/pose_bytes.hpp"
#include "session/row.hpp"
#include "session/session_database.hpp"
#include "session/session_lock.hpp"

namespace saccade {
namespace {

void makeDurable(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw IoError(path, "a file that can be opened", std::strerror(errno));
  const int synced = ::fsync(file);
  const int reason = errno;
  ::close(file);
  if (synced != 0) throw IoError(path, "data that reach the disk", std::strerror(reason));
}

/// Removes what SQLite keeps beside a database: under the name of a new one, it would be taken for the new one's.
void removeCompanions(const std::filesystem::path& path) {
  std::error_code ignored;
  for (const char* suffix : {"-journal", "-wal", "-shm"}) std::filesystem::remove(path.string() + suffix, ignored);
}

/// Puts what a killed writer left beside a session that is to be replaced into it: it is part of the old one,
/// which must stay whole until the new one is there.
void settleOld(const std::filesystem::path& path) {
  try {
    SQLite::Database(path.string(), SQLite::OPEN_READWRITE).exec("PRAGMA journal_mode = DELETE");
  } catch (const SQLite::Exception&) {
    return;  // no database: what lies beside it is removed as it is
  }
}

std::filesystem::path folderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

}  // namespace

struct SessionWriter::Statements {
  explicit Statements(SQLite::Database& db)
      : run(db, "INSERT INTO runs VALUES ((SELECT count(*) FROM runs),?,?,?,?,?)"),
        frame(db, "INSERT INTO frames VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        metrics(db, "INSERT INTO metrics VALUES (?,?)"),
        candidate(db, "INSERT INTO candidates VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        keyframe(db, "INSERT INTO keyframes VALUES (?,?,?,?,?,?,?,?,?)"),
        tile(db, "INSERT OR REPLACE INTO tiles VALUES (?,?,?,?,?)"),
        brick(db, "INSERT OR REPLACE INTO bricks VALUES (?,?,?,?,?)"),
        attend_log(db, "INSERT OR REPLACE INTO attend_log VALUES (?,?,?,?,?)"),
        state(db, "INSERT OR REPLACE INTO state VALUES (?,?,?)"),
        meta(db, "INSERT OR REPLACE INTO meta VALUES (?,?)") {}

  SQLite::Statement& blob(BlobTable table) {
    return table == BlobTable::kTiles ? tile : table == BlobTable::kBricks ? brick : attend_log;
  }

  SQLite::Statement run, frame, metrics, candidate, keyframe, tile, brick, attend_log, state, meta;
};

SessionWriter::SessionWriter(const std::filesystem::path& path, WhenSessionExists when_exists)
    : path_(path), partial_(path.string() + ".partial") {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored)) throw IoError(path_, "a file name for the session", "a folder");
  const bool exists = std::filesystem::exists(path_, ignored);
  if (when_exists == WhenSessionExists::kRefuse && exists) {
    throw IoError(path_, "no session of that name (--force replaces it)", "one that exists");
  }
  if (!std::filesystem::is_directory(folderOf(path_), ignored)) {
    throw IoError(folderOf(path_), "a folder to write the session to", "none");
  }
  if (exists) replaced_ = std::make_unique<SessionLock>(path_, SessionLock::WhenMissing::kFail);
  lock_ = std::make_unique<SessionLock>(partial_, SessionLock::WhenMissing::kCreate);
  try {
    std::filesystem::resize_file(partial_, 0, ignored);  // of a writer that was killed
    removeCompanions(partial_);
    database_ = std::make_unique<SessionDatabase>(partial_, SessionDatabase::Access::kCreate);
    begin();
  } catch (...) {
    database_.reset();
    std::filesystem::remove(partial_, ignored);
    throw;
  }
}

SessionWriter::SessionWriter(const std::filesystem::path& path) : path_(path) {
  if (!std::filesystem::is_regular_file(path_)) throw IoError(path_, "a session to go on with", "none");
  lock_ = std::make_unique<SessionLock>(path_, SessionLock::WhenMissing::kFail);
  database_ = std::make_unique<SessionDatabase>(path_, SessionDatabase::Access::kWrite);
  useLog();
  next_ordinal_ = database_->use("a whole Saccade session", [&] {
    return database_->sqlite().execAndGet("SELECT ifnull(max(ordinal) + 1, 0) FROM frames").getInt64();
  });
  begin();
}

std::unique_ptr<SessionWriter> SessionWriter::open(const std::filesystem::path& path) {
  return std::unique_ptr<SessionWriter>(new SessionWriter(path));
}

SessionWriter::~SessionWriter() {
  statements_.reset();
  database_.reset();
  std::error_code ignored;
  if (!partial_.empty()) std::filesystem::remove(partial_, ignored);
}

/// Commits go to SQLite's write-ahead log and are durable when they return.
void SessionWriter::useLog() {
  database_->use("a session file that can be written", [&] {
    database_->sqlite().exec("PRAGMA journal_mode = WAL");
    database_->sqlite().exec("PRAGMA synchronous = FULL");
  });
}

void SessionWriter::begin() {
  database_->use("a session file that can be written", [&] {
    if (!statements_) statements_ = std::make_unique<Statements>(database_->sqlite());
    database_->sqlite().exec("BEGIN IMMEDIATE");
  });
}

void SessionWriter::addRun(const RunRecord& run) {
  next_ordinal_ = std::max(next_ordinal_, run.first.value);
  database_->use("room for another run", [&] {
    insert(statements_->run, next_ordinal_, run.input, run.input_kind, run.started_utc, run.saccade_version);
  });
}

FrameOrdinal SessionWriter::addFrame(const FrameRecord& frame) {
  const FrameOrdinal ordinal{std::max(next_ordinal_, frame.ordinal.value)};
  next_ordinal_ = ordinal.value + 1;
  std::array<std::optional<double>, 7> pose;
  if (frame.T_WC) {
    const Eigen::Vector3d t = frame.T_WC->translation();
    const Eigen::Quaterniond q(frame.T_WC->rotation());
    pose = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  }
  database_->use("room for another frame", [&] {
    insert(statements_->frame, ordinal.value, frame.index.value, frame.name, frame.stamp_s, frame.tracking, pose,
           frame.inlier_share, frame.rms_m, frame.tick, frame.open, frame.inhibited, frame.attended,
           frame.processing_ms);
  });
  return ordinal;
}

void SessionWriter::addMetrics(const MetricsRecord& metrics) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  for (const auto& [stage, ms] : metrics.stages_ms) stages[stage] = ms;
  database_->use("room for the metrics", [&] { insert(statements_->metrics, metrics.ordinal.value, stages.dump()); });
}

void SessionWriter::addCandidate(const CandidateRecord& candidate) {
  const std::string features = nlohmann::json(candidate.features).dump();
  database_->use("room for another candidate", [&] {
    insert(statements_->candidate, candidate.frame.value, candidate.rank, candidate.score, candidate.source,
           candidate.box.x, candidate.box.y, candidate.box.width, candidate.box.height, candidate.box3d_m,
           candidate.mask_rle, features, candidate.revisited_share);
  });
}

void SessionWriter::addKeyframe(const KeyframeRecord& keyframe) {
  const std::string color = packColor(keyframe.color);
  const PackedDepth depth = packDepth(keyframe.depth_m);
  const std::string pose = poseBytes(keyframe.T_WC);
  database_->use("room for another keyframe", [&] {
    insert(statements_->keyframe, keyframe.ordinal.value, Bytes{pose}, Bytes{color}, crc32c(color), Bytes{depth.bytes},
           depth.unit_m, crc32c(depth.bytes), Bytes{keyframe.features}, crc32c(keyframe.features));
  });
}

void SessionWriter::putBlob(BlobTable table, const BlobRecord& blob) {
  const PackedBlob packed = packBlob(blob.bytes);
  database_->use("room for the map", [&] {
    insert(statements_->blob(table), blob.key, blob.items, packed.crc32c, packed.unpacked_size, Bytes{packed.bytes});
  });
}

void SessionWriter::removeBlob(BlobTable table, std::uint64_t key) {
  database_->use("a session that can be written", [&] {
    SQLite::Statement row(database_->sqlite(), std::string("DELETE FROM ") + nameOf(table) + " WHERE key = ?");
    insert(row, key);
  });
}

void SessionWriter::putState(const std::string& name, const std::string& bytes) {
  database_->use("room for the state", [&] { insert(statements_->state, name, crc32c(bytes), Bytes{bytes}); });
}

void SessionWriter::commit(const SessionMetadata& metadata) {
  SessionMetadata exploring = metadata;
  exploring.state = SessionState::kExploring;
  end(exploring);
  begin();
}

void SessionWriter::finish(const SessionMetadata& metadata) {
  end(metadata);
  statements_.reset();
  // Makes one plain file of it. With a reader at it that cannot be, and the session stays as durable in its two.
  constexpr int kPatience_ms = 500;
  database_->sqlite().setBusyTimeout(kPatience_ms);
  database_->sqlite().tryExec("PRAGMA journal_mode = DELETE");
  // Thinned images leave free pages in the file, which count for whoever bounds it.
  if (size_limit_ != 0) database_->sqlite().tryExec("VACUUM");
  database_.reset();
  lock_.reset();
}

void SessionWriter::limitSize(std::uint64_t bytes) {
  size_limit_ = bytes;
  committed_bytes_ = database_->use("a session that can be read", [&] { return usedBytes(); });
}

/// Bytes of the file that hold something; what was freed is used again.
std::uint64_t SessionWriter::usedBytes() const {
  const auto number = [&](const char* pragma) {
    return static_cast<std::uint64_t>(database_->sqlite().execAndGet(pragma).getInt64());
  };
  return (number("PRAGMA page_count") - number("PRAGMA freelist_count")) * number("PRAGMA page_size");
}

/// Drops the images of every second keyframe that has some; whether there were at least two.
bool SessionWriter::thinKeyframes() {
  const int thinned = database_->sqlite().exec(
      "UPDATE keyframes SET color = x'', color_crc32c = 0, depth = x'', depth_crc32c = 0 WHERE ordinal IN "
      "(SELECT ordinal FROM (SELECT ordinal, row_number() OVER (ORDER BY ordinal) AS n FROM keyframes "
      "WHERE length(color) > 0) WHERE n % 2 = 0)");
  return thinned > 0;
}

void SessionWriter::keepToLimit() {
  if (size_limit_ == 0) return;
  const std::uint64_t taken = std::max(usedBytes(), committed_bytes_) - committed_bytes_;
  // Two more commits come once it is full: one that is being filled, and the last. And a share for the objects.
  const std::uint64_t reserve = 2 * taken + size_limit_ / 16;
  bool fits = false;
  do {
    fits = usedBytes() + reserve <= size_limit_;
  } while (!fits && thinKeyframes());
  full_ = full_ || !fits;
  committed_bytes_ = usedBytes();
}

void SessionWriter::end(const SessionMetadata& metadata) {
  database_->use("room for the session", [&] {
    keepToLimit();
    for (const auto& [key, value] : metadataToText(metadata)) insert(statements_->meta, key, value);
    database_->sqlite().exec("COMMIT");
    if (partial_.empty()) database_->sqlite().exec("PRAGMA wal_checkpoint(PASSIVE)");
  });
  if (!partial_.empty()) appear();
}

/// Gives the partial file its name. SQLite names its journal after the database, so none may be open meanwhile.
void SessionWriter::appear() {
  statements_.reset();
  database_.reset();
  lock_->sync();
  if (replaced_) settleOld(path_);
  removeCompanions(path_);  // also of a session that was removed without them
  std::error_code failure;
  std::filesystem::rename(partial_, path_, failure);
  if (failure) throw IoError(path_, "a session that can be given its name", failure.message());
  partial_.clear();
  replaced_.reset();
  makeDurable(folderOf(path_));
  database_ = std::make_unique<SessionDatabase>(path_, SessionDatabase::Access::kWrite);
  useLog();
}

}  // namespace saccade
