#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace saccade::test {

/// All bytes of a file; none if it cannot be opened.
[[nodiscard]] inline std::string readFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace saccade::test
