#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "support/temporary_folder.hpp"

namespace saccade::fuzz {

/// Files for readers that want a path, in a folder that goes with the process.
class FuzzedFiles {
 public:
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

  [[nodiscard]] std::filesystem::path write(const char* name, const std::uint8_t* data, std::size_t size) const {
    const std::filesystem::path path = folder_ / name;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) throw std::runtime_error("cannot write the fuzzed file");
    const bool written = std::fwrite(data, 1, size, file) == size;
    if (std::fclose(file) != 0 || !written) throw std::runtime_error("cannot write the fuzzed file");
    return path;
  }

 private:
  test::TemporaryFolder folder_;
};

}  // namespace saccade::fuzz
