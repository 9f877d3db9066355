#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace saccade {

/// Something outside the program is not as it must be: a file is missing, damaged or of another kind, a disk is full.
///
/// `what()` is one sentence: "PATH: expected EXPECTED, found FOUND". Mistakes of the caller are std::invalid_argument.
class IoError : public std::runtime_error {
 public:
  IoError(const std::filesystem::path& path, const std::string& expected, const std::string& found)
      : std::runtime_error(path.string() + ": expected " + expected + ", found " + found),
        path_(path),
        expected_(expected),
        found_(found) {}

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::string& expected() const { return expected_; }
  [[nodiscard]] const std::string& found() const { return found_; }

 private:
  std::filesystem::path path_;
  std::string expected_;
  std::string found_;
};

}  // namespace saccade
