#include "saccade/session/session_writer.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
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
        keyframe(db, "INSERT INTO keyframes VALUES (?,?,?,?,?,?,?,?,?)") {}

  SQLite::Statement run, frame, metrics, candidate, keyframe;
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
  database_ = std::make_unique<SessionDatabase>(partial_, SessionDatabase::Access::kCreate);
  database_->use("a session file that can be written", [&] {
    SQLite::Database& db = database_->sqlite();
    // The partial file is worthless after a crash whatever its state, so it needs no journal; finish() syncs it once.
    db.exec("PRAGMA journal_mode = OFF");
    db.exec("PRAGMA synchronous = OFF");
    db.exec("BEGIN");
    statements_ = std::make_unique<Statements>(db);
  });
}

SessionWriter::~SessionWriter() {
  if (!database_) return;  // finished
  statements_.reset();
  database_.reset();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void SessionWriter::addRun(const RunRecord& run) {
  database_->use("room for another run", [&] {
    insert(statements_->run, next_ordinal_, run.input, run.input_kind, run.started_utc, run.saccade_version);
  });
}

FrameOrdinal SessionWriter::addFrame(const FrameRecord& frame) {
  const FrameOrdinal ordinal{next_ordinal_++};
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

void SessionWriter::addBlob(BlobTable table, const BlobRecord& blob) {
  const PackedBlob packed = packBlob(blob.bytes);
  database_->use("room for the map", [&] {
    SQLite::Statement row(database_->sqlite(), std::string("INSERT INTO ") + nameOf(table) + " VALUES (?,?,?,?,?)");
    insert(row, blob.key, blob.items, packed.crc32c, packed.unpacked_size, Bytes{packed.bytes});
  });
}

void SessionWriter::finish(const SessionMetadata& metadata) {
  database_->use("room for the session", [&] {
    SQLite::Statement row(database_->sqlite(), "INSERT INTO meta VALUES (?,?)");
    for (const auto& [key, value] : metadataToText(metadata)) insert(row, key, value);
    statements_.reset();
    database_->sqlite().exec("COMMIT");
  });
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
