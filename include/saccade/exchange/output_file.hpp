#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>

namespace saccade {

enum class WhenFileExists { kRefuse, kReplace };

/// A file that appears in one step: everything goes to `PATH.partial`, which finish() makes durable and renames.
///
/// PATH is always either what was there before or the whole new file; a file that is not finished leaves nothing
/// behind. Writers need not check the stream, since finish() does. Not thread-safe.
class OutputFile {
 public:
  /// Throws IoError if PATH is a folder, exists and may not be replaced, or cannot be made.
  OutputFile(const std::filesystem::path& path, WhenFileExists when_exists);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// For writers that want a name: they write to this one, and nothing to stream().
  [[nodiscard]] const std::filesystem::path& partialPath() const { return partial_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Makes the file durable and gives it its name. Throws IoError if anything did not reach the disk.
  void finish();

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;
  std::ofstream stream_;
  bool finished_ = false;
};

}  // namespace saccade
