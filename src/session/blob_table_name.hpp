#pragma once

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

}  // namespace saccade
