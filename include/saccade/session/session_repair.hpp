#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace saccade {

/// How much of one table of a session is whole.
struct TableFindings {
  std::string table;
  std::int64_t whole = 0;    ///< rows that can be read and make sense
  std::int64_t damaged = 0;  ///< rows that cannot, as far as they could be counted
};

/// What is wrong with a session.
struct SessionFindings {
  std::vector<TableFindings> tables;
  std::vector<std::string> complaints;  ///< one sentence each, at most kLargestCount; empty: the session is whole
  std::int64_t more_complaints = 0;     ///< beyond those

  static constexpr std::size_t kLargestCount = 100;
};

/// Looks at everything in a session: SQLite's own structure, every checksum, every tile, brick, tick and image decoded,
/// and whether its parts fit together. Reads, never writes. Memory: the largest part. Throws IoError if the file is no
/// session at all, or its table `meta` cannot be read.
[[nodiscard]] SessionFindings verifySession(const std::filesystem::path& path);

/// Writes a new session of the current format with everything of `damaged` that is whole, and says what is not in it.
/// Parts that hang on something lost (candidates of a lost frame) are left out too. Throws IoError as verifySession(),
/// or if `repaired` exists or cannot be written.
[[nodiscard]] SessionFindings repairSession(const std::filesystem::path& damaged,
                                            const std::filesystem::path& repaired);

}  // namespace saccade
