#pragma once

#include <filesystem>
#include <memory>

#include "saccade/session/session_records.hpp"

namespace saccade {

class SessionDatabase;

enum class WhenSessionExists { kRefuse, kReplace };

/// Tables of a session that hold parts of the map as blobs.
enum class BlobTable { kTiles, kBricks, kAttendLog };

/// Writes a session file (`*.saccade`: one SQLite database, see src/session/schema.hpp).
///
/// Everything goes to `PATH.partial` first; finish() makes it durable and renames it to PATH in one step, so PATH is
/// always either the session that was there before or the whole new one. Every failure of the outside world is an
/// IoError that names the path; after one, the old session is untouched and the partial file is removed. What goes
/// into the map's blobs is the map's own business. Not thread-safe.
class SessionWriter {
 public:
  /// Throws IoError if PATH exists and may not be replaced, or if its folder is missing or cannot be written.
  SessionWriter(const std::filesystem::path& path, WhenSessionExists when_exists);
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// Begins a run: the frames to come belong to it. `run` and `first` are filled in.
  void addRun(const RunRecord& run);
  /// The ordinal that the frame was given.
  FrameOrdinal addFrame(const FrameRecord& frame);
  void addMetrics(const MetricsRecord& metrics);
  void addCandidate(const CandidateRecord& candidate);
  void addKeyframe(const KeyframeRecord& keyframe);
  void addBlob(BlobTable table, const BlobRecord& blob);
  /// Writes the metadata, makes the file durable and gives it its name. Nothing can be added afterwards.
  void finish(const SessionMetadata& metadata);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The open file, for stages that keep tables of their own in it (src/session/session_database.hpp); until finish().
  [[nodiscard]] SessionDatabase& database() { return *database_; }

 private:
  struct Statements;
  std::filesystem::path path_;
  std::filesystem::path partial_;
  std::unique_ptr<SessionDatabase> database_;
  std::unique_ptr<Statements> statements_;
  std::int64_t next_ordinal_ = 0;
};

}  // namespace saccade
