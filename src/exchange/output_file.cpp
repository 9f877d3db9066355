#include "saccade/exchange/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

std::filesystem::path folderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

void makeDurable(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw IoError(path, "a file that can be opened", std::strerror(errno));
  const int synced = ::fsync(file);
  const int reason = errno;
  ::close(file);
  if (synced != 0) throw IoError(path, "data that reach the disk", std::strerror(reason));
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path, WhenFileExists when_exists)
    : path_(path), partial_(path.string() + ".partial") {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored)) throw IoError(path_, "a name for a file", "a folder");
  if (when_exists == WhenFileExists::kRefuse && std::filesystem::exists(path_, ignored)) {
    throw IoError(path_, "no file of that name (--force replaces it)", "one that exists");
  }
  if (!std::filesystem::is_directory(folderOf(path_), ignored)) {
    throw IoError(folderOf(path_), "a folder to write to", "none");
  }
  stream_.open(partial_, std::ios::binary | std::ios::trunc);
  if (!stream_) throw IoError(path_, "a file that can be written", std::strerror(errno));
}

OutputFile::~OutputFile() {
  if (finished_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void OutputFile::finish() {
  stream_.flush();
  const bool written = stream_.good();
  stream_.close();
  if (!written || stream_.fail()) throw IoError(path_, "room for the whole file", "a full or failing disk");
  makeDurable(partial_);
  std::error_code failure;
  std::filesystem::rename(partial_, path_, failure);
  if (failure) throw IoError(path_, "a file that can be given its name", failure.message());
  finished_ = true;
  makeDurable(folderOf(path_));
}

}  // namespace saccade
