#include "session/session_lock.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

/// Whether the name still leads to the open file: another writer may have renamed it before it was locked.
bool isNamed(int file, const std::filesystem::path& path) {
  struct stat open {
  }, named{};
  return ::fstat(file, &open) == 0 && ::stat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

}  // namespace

SessionLock::SessionLock(const std::filesystem::path& path, WhenMissing when_missing) : path_(path) {
  constexpr mode_t kMode = 0644;
  const int flags = O_RDWR | O_CLOEXEC | (when_missing == WhenMissing::kCreate ? O_CREAT : 0);
  for (;;) {
    file_ = ::open(path.c_str(), flags, kMode);
    if (file_ < 0) throw IoError(path, "a session file that can be written", std::strerror(errno));
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      ::close(file_);
      throw IoError(path, "a session that nobody else is writing", "another Saccade at work on it");
    }
    if (isNamed(file_, path)) return;
    ::close(file_);
  }
}

SessionLock::~SessionLock() {
  ::close(file_);
}

void SessionLock::sync() const {
  if (::fsync(file_) != 0) throw IoError(path_, "data that reach the disk", std::strerror(errno));
}

}  // namespace saccade
