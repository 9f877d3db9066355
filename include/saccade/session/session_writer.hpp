#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "saccade/session/session_records.hpp"

namespace saccade {

class SessionDatabase;
class SessionLock;

enum class WhenSessionExists { kRefuse, kReplace };

/// Tables of a session that hold parts of the map as blobs.
enum class BlobTable { kTiles, kBricks, kAttendLog };

/// Writes a session file (`*.saccade`: one SQLite database, see src/session/schema.hpp), checkpoint by checkpoint.
///
/// What is added becomes part of the session with the next commit(), all of it or nothing. A new session is written as
/// `PATH.partial` until its first commit, which makes it durable and renames it to PATH in one step: a session that was
/// there before is whole until the new one is. From then on PATH can be opened at any time and after any crash, and
/// says that it is being explored; finish() ends that. Readers do not disturb the writer, nor it them: commits go
/// through SQLite's write-ahead log, are synced, and are then moved into the file itself, so that between two commits
/// PATH alone is whole. (A rollback journal would write as much, but a copy of PATH taken while one commits is damage,
/// and a read-only reader cannot open what a killed writer left.) After finish() PATH is one plain file.
///
/// A second writer is refused. Every failure of the outside world is an IoError that names the path; the session then
/// is what the last commit left, and after one before the first commit the old session is untouched and no partial
/// file remains. What goes into the map's blobs is the map's own business. Not thread-safe.
class SessionWriter {
 public:
  /// Begins a new session. Throws IoError if PATH exists and may not be replaced, is being written, or if its folder is
  /// missing or cannot be written.
  SessionWriter(const std::filesystem::path& path, WhenSessionExists when_exists);
  /// Opens a session to go on with it. Throws IoError if it is no whole session of the current format, or is being
  /// written.
  [[nodiscard]] static std::unique_ptr<SessionWriter> open(const std::filesystem::path& path);
  /// Drops what was added since the last commit.
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// Begins a run: the frames to come belong to it. `run` is filled in, and `first` with the next ordinal unless it is
  /// later than that.
  void addRun(const RunRecord& run);
  /// The file is to take at most `bytes`. Where a commit would come near that, images of keyframes are left out, every
  /// second one first. A commit is reckoned to need as much room as the one before it.
  void limitSize(std::uint64_t bytes);
  /// Whether the next commits would not fit into the limit: time to finish().
  [[nodiscard]] bool full() const { return full_; }
  /// Adds a frame as the next one, or under its own ordinal if that is later, and returns which it is.
  FrameOrdinal addFrame(const FrameRecord& frame);
  void addMetrics(const MetricsRecord& metrics);
  void addCandidate(const CandidateRecord& candidate);
  void addKeyframe(const KeyframeRecord& keyframe);
  /// Writes a part of the map, in place of one with the same key.
  void putBlob(BlobTable table, const BlobRecord& blob);
  void removeBlob(BlobTable table, std::uint64_t key);
  /// Keeps bytes under a name, in place of what was there, for SessionReader::state().
  void putState(const std::string& name, const std::string& bytes);

  /// A checkpoint: makes all that was added durable, as a session that is still being explored.
  void commit(const SessionMetadata& metadata);
  /// The last commit, with the metadata's own state. Nothing can be added afterwards.
  void finish(const SessionMetadata& metadata);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The ordinal of the next frame.
  [[nodiscard]] FrameOrdinal nextOrdinal() const { return {next_ordinal_}; }
  /// The open file, for stages that keep tables of their own in it (src/session/session_database.hpp); what they
  /// write belongs to the next commit. Until finish().
  [[nodiscard]] SessionDatabase& database() { return *database_; }

 private:
  struct Statements;

  explicit SessionWriter(const std::filesystem::path& path);
  void begin();
  void end(const SessionMetadata& metadata);
  void appear();
  void useLog();
  [[nodiscard]] std::uint64_t usedBytes() const;
  [[nodiscard]] bool thinKeyframes();
  void keepToLimit();

  std::filesystem::path path_;
  std::filesystem::path partial_;  // the file's name until it appears; then empty
  std::unique_ptr<SessionLock> lock_;
  std::unique_ptr<SessionLock> replaced_;  // of the session that was there before, until the new one appears
  std::unique_ptr<SessionDatabase> database_;
  std::unique_ptr<Statements> statements_;
  std::int64_t next_ordinal_ = 0;
  std::uint64_t size_limit_ = 0;       // 0: none
  std::uint64_t committed_bytes_ = 0;  // that the last commit left in use
  bool full_ = false;
};

}  // namespace saccade
