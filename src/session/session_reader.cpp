#include "saccade/session/session_reader.hpp"

#include <map>

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

constexpr const char* kWhole = "a whole Saccade session";

SessionMetadata readMetadata(const SessionDatabase& database) {
  std::map<std::string, std::string> rows;
  SQLite::Statement query(database.sqlite(), "SELECT key, value FROM meta");
  while (query.executeStep()) rows[query.getColumn(0).getString()] = query.getColumn(1).getString();
  if (database.formatVersion() == 1) {
    rows["state"] = rows["interrupted"] == "true" ? "\"interrupted\"" : "\"complete\"";
  }
  rows.emplace("range_step", "1");  // not in the first files of version 2
  return metadataFromText(rows, database.path());
}

void requireChecksum(std::string_view bytes, std::int64_t crc, const std::string& what,
                     const std::filesystem::path& path) {
  if (crc32c(bytes) != crc) throw IoError(path, "undamaged " + what, "a wrong checksum");
}

std::string blobQuery(BlobTable table) {
  return std::string("SELECT key, items, crc32c, size, data FROM ") + nameOf(table);
}

BlobRecord readBlob(SQLite::Statement& query, BlobTable table, const std::filesystem::path& path) {
  RowReader row(query);
  BlobRecord blob;
  blob.key = static_cast<std::uint64_t>(row.integer());
  blob.items = static_cast<std::uint64_t>(row.integer());
  const auto crc = static_cast<std::uint32_t>(row.integer());
  const auto size = static_cast<std::uint64_t>(row.integer());
  blob.bytes = unpackBlob(row.bytes(), crc, size, largestBlob(table), path,
                          std::string("part ") + std::to_string(blob.key) + " of table " + nameOf(table));
  return blob;
}

constexpr const char* kFrameQuery =
    "SELECT ordinal, frame, name, stamp_s, tracking, tx, ty, tz, qx, qy, qz, qw, inlier_share, rms_m, tick, open, "
    "inhibited, attended, processing_ms FROM frames";

FrameRecord readFrame(SQLite::Statement& query) {
  RowReader row(query);
  FrameRecord frame;
  frame.ordinal = {row.integer()};
  frame.index = {row.integer()};
  frame.name = row.text();
  frame.stamp_s = row.number();
  frame.tracking = row.text();
  const bool has_pose = !row.nextIsNull();
  std::array<double, 7> pose{};
  for (double& value : pose) value = row.number();
  if (has_pose) {
    frame.T_WC = Pose(Eigen::Translation3d(pose[0], pose[1], pose[2]) *
                      Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]).normalized());
  }
  frame.inlier_share = row.number();
  frame.rms_m = row.number();
  frame.tick = static_cast<std::uint32_t>(row.integer());
  frame.open = static_cast<int>(row.integer());
  frame.inhibited = static_cast<int>(row.integer());
  frame.attended = static_cast<int>(row.integer());
  frame.processing_ms = row.number();
  return frame;
}

std::string nameOf(FrameOrdinal ordinal) {
  return "keyframe " + std::to_string(ordinal.value);
}

}  // namespace

SessionReader::SessionReader(const std::filesystem::path& path)
    : database_(std::make_unique<SessionDatabase>(path, SessionDatabase::Access::kRead)) {
  metadata_ = database_->use(kWhole, [&] { return readMetadata(*database_); });
}

SessionReader::~SessionReader() = default;

const std::filesystem::path& SessionReader::path() const {
  return database_->path();
}

std::vector<RunRecord> SessionReader::runs() const {
  return database_->use(kWhole, [&] {
    std::vector<RunRecord> runs;
    SQLite::Statement query(database_->sqlite(),
                            "SELECT run, first_ordinal, input, input_kind, started_utc, saccade_version FROM runs "
                            "ORDER BY run");
    while (query.executeStep()) {
      RowReader row(query);
      RunRecord run;
      run.run = static_cast<int>(row.integer());
      run.first = {row.integer()};
      run.input = row.text();
      run.input_kind = row.text();
      run.started_utc = row.text();
      run.saccade_version = row.text();
      runs.push_back(std::move(run));
    }
    return runs;
  });
}

std::vector<FrameRecord> SessionReader::frames() const {
  return database_->use(kWhole, [&] {
    std::vector<FrameRecord> frames;
    SQLite::Statement query(database_->sqlite(), std::string(kFrameQuery) + " ORDER BY ordinal");
    while (query.executeStep()) frames.push_back(readFrame(query));
    return frames;
  });
}

std::optional<FrameRecord> SessionReader::frame(FrameOrdinal ordinal) const {
  return database_->use(kWhole, [&]() -> std::optional<FrameRecord> {
    SQLite::Statement query(database_->sqlite(), std::string(kFrameQuery) + " WHERE ordinal = ?");
    query.bind(1, ordinal.value);
    if (!query.executeStep()) return std::nullopt;
    return readFrame(query);
  });
}

std::vector<MetricsRecord> SessionReader::metrics() const {
  return database_->use(kWhole, [&] {
    std::vector<MetricsRecord> metrics;
    SQLite::Statement query(database_->sqlite(), "SELECT ordinal, stages FROM metrics ORDER BY ordinal");
    while (query.executeStep()) {
      RowReader row(query);
      MetricsRecord record;
      record.ordinal = {row.integer()};
      const auto stages = nlohmann::ordered_json::parse(row.text(), nullptr, false);
      if (!stages.is_object()) throw IoError(path(), "a JSON object of stages", "something else");
      for (const auto& [stage, ms] : stages.items()) {
        record.stages_ms.emplace_back(stage, ms.is_number() ? ms.get<double>() : 0.0);
      }
      metrics.push_back(std::move(record));
    }
    return metrics;
  });
}

std::vector<CandidateRecord> SessionReader::candidates(FrameOrdinal frame) const {
  return database_->use(kWhole, [&] {
    std::vector<CandidateRecord> candidates;
    SQLite::Statement query(
        database_->sqlite(),
        "SELECT rank, score, source, u, v, width, height, min_x, min_y, min_z, max_x, max_y, max_z, "
        "mask, features, revisited_share FROM candidates WHERE ordinal = ? ORDER BY rank");
    query.bind(1, frame.value);
    while (query.executeStep()) {
      RowReader row(query);
      CandidateRecord candidate;
      candidate.frame = frame;
      candidate.rank = static_cast<int>(row.integer());
      candidate.score = row.number();
      candidate.source = row.text();
      for (int* value : {&candidate.box.x, &candidate.box.y, &candidate.box.width, &candidate.box.height}) {
        *value = static_cast<int>(row.integer());
      }
      for (double& value : candidate.box3d_m) value = row.number();
      candidate.mask_rle = row.text();
      const nlohmann::json features = nlohmann::json::parse(row.text(), nullptr, false);
      if (!features.is_array()) throw IoError(path(), "a JSON array of features", "something else");
      for (const auto& feature : features) {
        candidate.features.push_back(feature.is_number() ? feature.get<double>() : 0);
      }
      candidate.revisited_share = row.number();
      candidates.push_back(std::move(candidate));
    }
    return candidates;
  });
}

std::int64_t SessionReader::candidateCount() const {
  return database_->use(kWhole,
                        [&] { return database_->sqlite().execAndGet("SELECT count(*) FROM candidates").getInt64(); });
}

std::vector<KeyframeRecord> SessionReader::keyframes() const {
  return database_->use(kWhole, [&] {
    std::vector<KeyframeRecord> keyframes;
    SQLite::Statement query(database_->sqlite(),
                            "SELECT ordinal, T_WC, features_crc32c, features FROM keyframes ORDER BY ordinal");
    while (query.executeStep()) {
      RowReader row(query);
      KeyframeRecord keyframe;
      keyframe.ordinal = {row.integer()};
      const std::optional<Pose> T_WC = poseFromBytes(row.bytes());
      if (!T_WC) throw IoError(path(), "the pose of " + nameOf(keyframe.ordinal), "something else");
      keyframe.T_WC = *T_WC;
      const std::int64_t crc = row.integer();
      keyframe.features = std::string(row.bytes());
      requireChecksum(keyframe.features, crc, "features of " + nameOf(keyframe.ordinal), path());
      keyframes.push_back(std::move(keyframe));
    }
    return keyframes;
  });
}

std::optional<KeyframeRecord> SessionReader::keyframe(FrameOrdinal ordinal) const {
  return database_->use(kWhole, [&]() -> std::optional<KeyframeRecord> {
    SQLite::Statement query(database_->sqlite(),
                            "SELECT T_WC, features_crc32c, features, color_crc32c, color, depth_unit_m, depth_crc32c, "
                            "depth FROM keyframes WHERE ordinal = ?");
    query.bind(1, ordinal.value);
    if (!query.executeStep()) return std::nullopt;
    RowReader row(query);
    KeyframeRecord keyframe;
    keyframe.ordinal = ordinal;
    const std::optional<Pose> T_WC = poseFromBytes(row.bytes());
    if (!T_WC) throw IoError(path(), "the pose of " + nameOf(ordinal), "something else");
    keyframe.T_WC = *T_WC;
    const std::int64_t features_crc = row.integer();
    keyframe.features = std::string(row.bytes());
    requireChecksum(keyframe.features, features_crc, "features of " + nameOf(ordinal), path());
    const cv::Size size(metadata_.camera.width, metadata_.camera.height);
    const std::int64_t color_crc = row.integer();
    const std::string_view color = row.bytes();
    requireChecksum(color, color_crc, "colour image of " + nameOf(ordinal), path());
    keyframe.color = unpackColor(color, size, path());
    const double unit_m = row.number();
    const std::int64_t depth_crc = row.integer();
    const std::string_view depth = row.bytes();
    requireChecksum(depth, depth_crc, "depth image of " + nameOf(ordinal), path());
    keyframe.depth_m = unpackDepth(depth, unit_m, size, path());
    return keyframe;
  });
}

std::vector<std::string> SessionReader::stateNames() const {
  return database_->use(kWhole, [&] {
    std::vector<std::string> names;
    SQLite::Statement query(database_->sqlite(), "SELECT name FROM state ORDER BY name");
    while (query.executeStep()) names.push_back(query.getColumn(0).getString());
    return names;
  });
}

std::optional<std::string> SessionReader::state(const std::string& name) const {
  return database_->use(kWhole, [&]() -> std::optional<std::string> {
    SQLite::Statement query(database_->sqlite(), "SELECT crc32c, data FROM state WHERE name = ?");
    query.bind(1, name);
    if (!query.executeStep()) return std::nullopt;
    RowReader row(query);
    const std::int64_t crc = row.integer();
    std::string bytes(row.bytes());
    requireChecksum(bytes, crc, "state \"" + name + "\"", path());
    return bytes;
  });
}

void SessionReader::visitBlobs(BlobTable table, const std::function<void(const BlobRecord&)>& visit) const {
  visitBlobs(
      table, [](std::uint64_t) { return true; }, visit);
}

void SessionReader::visitBlobs(BlobTable table, const std::function<bool(std::uint64_t)>& wanted,
                               const std::function<void(const BlobRecord&)>& visit) const {
  database_->use(kWhole, [&] {
    SQLite::Statement query(database_->sqlite(), blobQuery(table) + " ORDER BY key");
    while (query.executeStep()) {
      if (wanted(static_cast<std::uint64_t>(query.getColumn(0).getInt64()))) visit(readBlob(query, table, path()));
    }
  });
}

std::vector<BlobKey> SessionReader::blobKeys(BlobTable table) const {
  return database_->use(kWhole, [&] {
    std::vector<BlobKey> keys;
    SQLite::Statement query(database_->sqlite(),
                            std::string("SELECT key, items FROM ") + nameOf(table) + " ORDER BY key");
    while (query.executeStep()) {
      RowReader row(query);
      const auto key = static_cast<std::uint64_t>(row.integer());
      keys.push_back({key, static_cast<std::uint64_t>(row.integer())});
    }
    return keys;
  });
}

std::optional<BlobRecord> SessionReader::blob(BlobTable table, std::uint64_t key) const {
  return database_->use(kWhole, [&]() -> std::optional<BlobRecord> {
    SQLite::Statement query(database_->sqlite(), blobQuery(table) + " WHERE key = ?");
    query.bind(1, static_cast<std::int64_t>(key));
    if (!query.executeStep()) return std::nullopt;
    return readBlob(query, table, path());
  });
}

}  // namespace saccade
