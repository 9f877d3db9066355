#pragma once

#include <filesystem>

namespace saccade {

/// Keeps a second writer from a session file while it lives. Readers are not kept out.
///
/// It follows the file, not its name: a file that is renamed stays locked. It must outlive every SQLite connection of
/// this process to the file, since closing any descriptor of a file ends SQLite's own locks on it.
class SessionLock {
 public:
  enum class WhenMissing { kFail, kCreate };

  /// Throws IoError if another writer has the file, or if it cannot be opened.
  SessionLock(const std::filesystem::path& path, WhenMissing when_missing);
  ~SessionLock();
  SessionLock(const SessionLock&) = delete;
  SessionLock& operator=(const SessionLock&) = delete;

  /// Makes what was written to the file durable. Throws IoError if that cannot be.
  void sync() const;

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace saccade
