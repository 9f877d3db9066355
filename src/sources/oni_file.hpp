#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace saccade {

/// One stream of an .oni file: how many frames its head promises, and how many are in the file in full.
struct OniStreamExtent {
  std::uint32_t node = 0;
  std::uint32_t promised_frames = 0;
  std::int64_t frames = 0;
};

/// What an .oni file holds, from a walk over the heads of its records. OpenNI2's player tells little about a file that
/// is cut off, and gives no reason where it cannot open one.
struct OniFileExtent {
  /// False for files of OpenNI 1, whose heads promise nothing.
  bool is_known_format = false;
  std::vector<OniStreamExtent> streams;
  std::uint64_t records_end = 0;  ///< position behind the last whole record

  /// Whether all streams have the frames that their heads promise.
  [[nodiscard]] bool isWhole() const;
};

/// Reads the extent of an .oni file. Throws IoError where it cannot be read or is none.
[[nodiscard]] OniFileExtent readOniExtent(const std::filesystem::path& path);

/// Moves the mark of the file's end to where the records end. OpenNI2's recorder leaves a hole before it that is as
/// long as the recording. Throws IoError.
void closeOniGap(const std::filesystem::path& path, const OniFileExtent& extent);

}  // namespace saccade
