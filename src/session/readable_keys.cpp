#include "session/readable_keys.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace saccade {
namespace {

constexpr int kDeepestBisection = 24;  // of the gap around a damaged page
constexpr int kMostFailures = 10'000;  // a file of nothing but damage ends here

class KeySearch {
 public:
  /// @throws SQLite::Exception if there is no such table, or its description is damaged
  KeySearch(const SessionDatabase& database, const std::string& table, const std::string& column)
      : KeySearch(database,
                  "SELECT " + column + " FROM " + table + " WHERE " + column + " BETWEEN ? AND ? ORDER BY " + column) {}

  void search(std::int64_t low, std::int64_t high, int depth) {
    if (low > high || failures_ > kMostFailures) return;
    const std::size_t begin = found.keys.size();
    if (scan(upwards_, low, high)) return;
    const std::int64_t first_gap = found.keys.size() > begin ? found.keys.back() + 1 : low;
    const std::size_t middle = found.keys.size();
    if (scan(downwards_, first_gap, high)) return;
    const std::int64_t last_gap = found.keys.size() > middle ? found.keys.back() - 1 : high;
    if (depth == kDeepestBisection || first_gap > last_gap) return;
    const std::int64_t half = first_gap + (last_gap - first_gap) / 2;
    search(first_gap, half, depth + 1);
    search(half + 1, last_gap, depth + 1);
  }

  ReadableKeys found;

 private:
  KeySearch(const SessionDatabase& database, const std::string& query)
      : upwards_(database.sqlite(), query), downwards_(database.sqlite(), query + " DESC") {}

  /// Whether the whole range could be read.
  bool scan(SQLite::Statement& query, std::int64_t low, std::int64_t high) {
    try {
      query.tryReset();  // which tells of the last failure again
      query.bind(1, low);
      query.bind(2, high);
      while (query.executeStep()) found.keys.push_back(query.getColumn(0).getInt64());
      return true;
    } catch (const SQLite::Exception&) {
      ++failures_;
      found.complete = false;
      return false;
    }
  }

  SQLite::Statement upwards_, downwards_;  ///< made once: a damaged table is asked thousands of times
  int failures_ = 0;
};

}  // namespace

ReadableKeys readableKeys(const SessionDatabase& database, const std::string& table, const std::string& column) {
  std::optional<KeySearch> search;
  try {
    search.emplace(database, table, column);
  } catch (const SQLite::Exception&) {
    return {{}, false};
  }
  // Keys are not negative; half the range suffices, and its width does not overflow.
  search->search(0, std::numeric_limits<std::int64_t>::max(), 0);
  std::vector<std::int64_t>& keys = search->found.keys;
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return std::move(search->found);
}

}  // namespace saccade
