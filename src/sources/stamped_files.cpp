#include "sources/stamped_files.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "saccade/core/errors.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {

std::vector<StampedFile> readStampedFiles(const std::filesystem::path& list) {
  std::ifstream file(list);
  if (!file) throw IoError(list, "a list of stamps and files", "nothing that can be read");
  std::vector<StampedFile> files;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string_view> words = splitWords(line);
    if (words.empty() || words[0].front() == '#') continue;
    const std::optional<double> stamp_s = parseNumber(words[0]);
    if (words.size() < 2 || !stamp_s || !std::isfinite(*stamp_s)) {
      throw IoError(list, "\"stamp file\" in line " + std::to_string(number), inQuotes(line));
    }
    files.push_back({*stamp_s, list.parent_path() / std::filesystem::path(words[1])});
  }
  if (files.empty()) throw IoError(list, "a list of stamps and files", "an empty list");
  std::stable_sort(files.begin(), files.end(),
                   [](const StampedFile& a, const StampedFile& b) { return a.stamp_s < b.stamp_s; });
  return files;
}

std::vector<double> stampsOf(const std::vector<StampedFile>& files) {
  std::vector<double> stamps;
  for (const StampedFile& file : files) stamps.push_back(file.stamp_s);
  return stamps;
}

}  // namespace saccade
