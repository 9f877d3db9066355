#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "saccade/session/session_records.hpp"
#include "saccade/session/session_writer.hpp"

namespace saccade {

class SessionDatabase;

/// Reads a session file; never writes to it.
///
/// Anything that is not a whole session of a known format version is an IoError with path, expected and found.
class SessionReader {
 public:
  explicit SessionReader(const std::filesystem::path& path);
  ~SessionReader();
  SessionReader(const SessionReader&) = delete;
  SessionReader& operator=(const SessionReader&) = delete;

  [[nodiscard]] const SessionMetadata& metadata() const { return metadata_; }
  [[nodiscard]] const std::filesystem::path& path() const;
  /// The explorations that made the session, oldest first.
  [[nodiscard]] std::vector<RunRecord> runs() const;
  /// All frames in the order of processing, with their poses: the trajectory.
  [[nodiscard]] std::vector<FrameRecord> frames() const;
  [[nodiscard]] std::optional<FrameRecord> frame(FrameOrdinal ordinal) const;
  /// Time of each stage, frame by frame.
  [[nodiscard]] std::vector<MetricsRecord> metrics() const;
  /// The attended candidates of one frame by rank.
  [[nodiscard]] std::vector<CandidateRecord> candidates(FrameOrdinal frame) const;
  /// Number of attended candidates in the whole session.
  [[nodiscard]] std::int64_t candidateCount() const;
  /// All keyframes in the order of processing, with poses and features but without their images, which keyframe()
  /// gives.
  [[nodiscard]] std::vector<KeyframeRecord> keyframes() const;
  /// One keyframe with its images; none if the frame is no keyframe.
  [[nodiscard]] std::optional<KeyframeRecord> keyframe(FrameOrdinal ordinal) const;
  /// Bytes that were kept under a name by SessionWriter::putState().
  [[nodiscard]] std::optional<std::string> state(const std::string& name) const;
  /// The names that state() knows.
  [[nodiscard]] std::vector<std::string> stateNames() const;
  /// Calls `visit` with every blob of `table` in the order of its keys, unpacked and checked.
  void visitBlobs(BlobTable table, const std::function<void(const BlobRecord&)>& visit) const;
  /// The same with those blobs alone whose key `wanted` accepts; the others are not unpacked.
  void visitBlobs(BlobTable table, const std::function<bool(std::uint64_t key)>& wanted,
                  const std::function<void(const BlobRecord&)>& visit) const;

  /// The keys of a table's blobs in their order, and how much each holds.
  [[nodiscard]] std::vector<BlobKey> blobKeys(BlobTable table) const;

  /// One blob, unpacked and checked; none if there is none of that key.
  [[nodiscard]] std::optional<BlobRecord> blob(BlobTable table, std::uint64_t key) const;

  /// The open file, for stages that keep tables of their own in it (src/session/session_database.hpp).
  [[nodiscard]] const SessionDatabase& database() const { return *database_; }

 private:
  std::unique_ptr<SessionDatabase> database_;
  SessionMetadata metadata_;
};

}  // namespace saccade
