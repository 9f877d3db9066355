#include "saccade/session/session_reader.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <map>
#include <system_error>

#include <nlohmann/json.hpp>

#include "saccade/core/errors.hpp"
#include "session/blob_codec.hpp"
#include "session/blob_table_name.hpp"
#include "session/metadata_json.hpp"
#include "session/schema.hpp"

namespace saccade {
namespace {

/// Runs `read` and turns what SQLite throws into an IoError.
template <typename Read>
auto reading(const std::filesystem::path& path, const Read& read) {
  try {
    return read();
  } catch (const SQLite::Exception& error) {
    throw IoError(path, "a whole Saccade session", error.what());
  }
}

int pragma(SQLite::Database& db, const char* name) {
  return db.execAndGet(std::string("PRAGMA ") + name).getInt();
}

}  // namespace

struct SessionReader::Database {
  explicit Database(const std::filesystem::path& path) : db(path.string(), SQLite::OPEN_READONLY) {}
  mutable SQLite::Database db;
};

SessionReader::SessionReader(const std::filesystem::path& path) : path_(path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path_, ignored)) {
    throw IoError(path_, "a session file", std::filesystem::exists(path_, ignored) ? "a folder or device" : "nothing");
  }
  reading(path_, [&] {
    database_ = std::make_unique<Database>(path_);
    const int application = pragma(database_->db, "application_id");
    if (application != schema::kApplicationId) {
      throw IoError(path_, "a Saccade session", "an SQLite database of another program");
    }
    const int version = pragma(database_->db, "user_version");
    if (version < 1 || version > schema::kFormatVersion) {
      throw IoError(path_, "a session of format version 1 to " + std::to_string(schema::kFormatVersion),
                    "version " + std::to_string(version) + " (a newer Saccade wrote it)");
    }
    std::map<std::string, std::string> rows;
    SQLite::Statement query(database_->db, "SELECT key, value FROM meta");
    while (query.executeStep()) rows[query.getColumn(0).getString()] = query.getColumn(1).getString();
    metadata_ = metadataFromText(rows, path_);
  });
}

SessionReader::~SessionReader() = default;

std::vector<FrameRecord> SessionReader::frames() const {
  return reading(path_, [&] {
    std::vector<FrameRecord> frames;
    SQLite::Statement query(database_->db, "SELECT * FROM frames ORDER BY ordinal");
    while (query.executeStep()) {
      FrameRecord frame;
      int column = 1;
      const auto next = [&] { return query.getColumn(column++); };
      frame.index = {next().getInt64()};
      frame.name = next().getString();
      frame.stamp_s = next().getDouble();
      frame.tracking = next().getString();
      const bool has_pose = !query.getColumn(column).isNull();
      std::array<double, 7> pose{};
      for (double& value : pose) value = next().getDouble();
      if (has_pose) {
        frame.T_WC = Pose(Eigen::Translation3d(pose[0], pose[1], pose[2]) *
                          Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]).normalized());
      }
      frame.inlier_share = next().getDouble();
      frame.rms_m = next().getDouble();
      frame.tick = next().getUInt();
      frame.open = next().getInt();
      frame.inhibited = next().getInt();
      frame.attended = next().getInt();
      frame.processing_ms = next().getDouble();
      frames.push_back(std::move(frame));
    }
    return frames;
  });
}

std::vector<CandidateRecord> SessionReader::candidates(FrameIndex frame) const {
  return reading(path_, [&] {
    std::vector<CandidateRecord> candidates;
    SQLite::Statement query(database_->db, "SELECT * FROM candidates WHERE frame = ? ORDER BY rank");
    query.bind(1, frame.value);
    while (query.executeStep()) {
      CandidateRecord candidate;
      int column = 0;
      const auto next = [&] { return query.getColumn(column++); };
      candidate.frame = {next().getInt64()};
      candidate.rank = next().getInt();
      candidate.score = next().getDouble();
      candidate.source = next().getString();
      for (int* value : {&candidate.box.x, &candidate.box.y, &candidate.box.width, &candidate.box.height}) {
        *value = next().getInt();
      }
      for (double& value : candidate.box3d_m) value = next().getDouble();
      candidate.mask_rle = next().getString();
      const nlohmann::json features = nlohmann::json::parse(next().getString(), nullptr, false);
      if (!features.is_array()) throw IoError(path_, "a JSON array of features", "something else");
      for (const auto& feature : features)
        candidate.features.push_back(feature.is_number() ? feature.get<double>() : 0);
      candidate.revisited_share = next().getDouble();
      candidates.push_back(std::move(candidate));
    }
    return candidates;
  });
}

std::int64_t SessionReader::candidateCount() const {
  return reading(path_, [&] { return database_->db.execAndGet("SELECT count(*) FROM candidates").getInt64(); });
}

void SessionReader::visitBlobs(BlobTable table, const std::function<void(const BlobRecord&)>& visit) const {
  reading(path_, [&] {
    const std::string name = nameOf(table);
    SQLite::Statement query(database_->db, "SELECT key, items, crc32c, size, data FROM " + name + " ORDER BY key");
    while (query.executeStep()) {
      BlobRecord blob;
      blob.key = static_cast<std::uint64_t>(query.getColumn(0).getInt64());
      blob.items = static_cast<std::uint64_t>(query.getColumn(1).getInt64());
      const SQLite::Column data = query.getColumn(4);
      const std::string_view packed(static_cast<const char*>(data.getBlob()),
                                    static_cast<std::size_t>(data.getBytes()));
      blob.bytes =
          unpackBlob(packed, query.getColumn(2).getUInt(), static_cast<std::uint64_t>(query.getColumn(3).getInt64()),
                     path_, "part " + std::to_string(blob.key) + " of table " + name);
      visit(blob);
    }
  });
}

}  // namespace saccade
