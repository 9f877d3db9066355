#pragma once

#include <filesystem>
#include <vector>

namespace saccade {

/// One line of a TUM list.
struct StampedFile {
  double stamp_s = 0.0;
  std::filesystem::path path;
};

/// The furthest that the stamps of a colour and a depth image of one frame may lie apart.
inline constexpr double kSamePairStamps_s = 0.02;

/// Reads a TUM list (`stamp file` a line, # for comments), by rising stamp. Throws IoError, with the line where there
/// is one, also if the list is empty.
[[nodiscard]] std::vector<StampedFile> readStampedFiles(const std::filesystem::path& list);

[[nodiscard]] std::vector<double> stampsOf(const std::vector<StampedFile>& files);

}  // namespace saccade
