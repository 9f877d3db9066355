#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "saccade/session/session_records.hpp"
#include "saccade/session/session_writer.hpp"

namespace saccade {

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
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// All frames in the order of processing.
  [[nodiscard]] std::vector<FrameRecord> frames() const;
  /// The attended candidates of one frame by rank.
  [[nodiscard]] std::vector<CandidateRecord> candidates(FrameIndex frame) const;
  /// Number of attended candidates in the whole session.
  [[nodiscard]] std::int64_t candidateCount() const;
  /// Calls `visit` with every blob of `table` in the order of its keys, unpacked and checked.
  void visitBlobs(BlobTable table, const std::function<void(const BlobRecord&)>& visit) const;

 private:
  struct Database;
  std::filesystem::path path_;
  std::unique_ptr<Database> database_;
  SessionMetadata metadata_;
};

}  // namespace saccade
