#pragma once

#include <cstdint>

#include "saccade/session/session_writer.hpp"

namespace saccade {

/// The SQL name of a blob table.
[[nodiscard]] constexpr const char* nameOf(BlobTable table) {
  switch (table) {
    case BlobTable::kTiles:
      return "tiles";
    case BlobTable::kBricks:
      return "bricks";
    case BlobTable::kAttendLog:
      return "attend_log";
  }
  return "";
}

/// Most bytes that an unpacked blob of the table can have: what claims more is damaged or hostile.
[[nodiscard]] constexpr std::uint64_t largestBlob(BlobTable table) {
  switch (table) {
    case BlobTable::kTiles:
      return 16U << 20U;  // 64^3 leaves with payload and their families: 4.3 MiB
    case BlobTable::kBricks:
      return 64U << 10U;  // 2 KiB today
    case BlobTable::kAttendLog:
      return 64U << 20U;  // every pixel of an image attended by 20 candidates
  }
  return 0;
}

}  // namespace saccade
