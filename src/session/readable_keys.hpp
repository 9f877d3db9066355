#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "session/session_database.hpp"

namespace saccade {

/// Keys of the rows of a table that can be reached, in rising order.
struct ReadableKeys {
  std::vector<std::int64_t> keys;
  bool complete = true;  ///< false: SQLite could not read some page between them
};

/// The keys in `column` of `table`. Where a page of the table is damaged, the keys on both sides of it are found by
/// bisection.
[[nodiscard]] ReadableKeys readableKeys(const SessionDatabase& database, const std::string& table,
                                        const std::string& column);

}  // namespace saccade
