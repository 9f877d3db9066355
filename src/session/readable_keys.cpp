#include "session/readable_keys.hpp"

#include <algorithm>
#include <limits>

namespace saccade {
namespace {

constexpr int kDeepestBisection = 24;  // of the gap around a damaged page
constexpr int kMostFailures = 10'000;  // a file of nothing but damage ends here

class KeySearch {
 public:
  KeySearch(const SessionDatabase& database, const std::string& table, const std::string& column)
      : database_(database),
        query_("SELECT " + column + " FROM " + table + " WHERE " + column + " BETWEEN ? AND ? ORDER BY " + column) {}

  void search(std::int64_t low, std::int64_t high, int depth) {
    if (low > high || failures_ > kMostFailures) return;
    const std::size_t begin = found.keys.size();
    if (scan(low, high, "")) return;
    const std::int64_t first_gap = found.keys.size() > begin ? found.keys.back() + 1 : low;
    const std::size_t middle = found.keys.size();
    if (scan(first_gap, high, " DESC")) return;
    const std::int64_t last_gap = found.keys.size() > middle ? found.keys.back() - 1 : high;
    if (depth == kDeepestBisection || first_gap > last_gap) return;
    const std::int64_t half = first_gap + (last_gap - first_gap) / 2;
    search(first_gap, half, depth + 1);
    search(half + 1, last_gap, depth + 1);
  }

  ReadableKeys found;

 private:
  /// Whether the whole range could be read.
  bool scan(std::int64_t low, std::int64_t high, const char* order) {
    try {
      SQLite::Statement query(database_.sqlite(), query_ + order);
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

  const SessionDatabase& database_;
  std::string query_;
  int failures_ = 0;
};

}  // namespace

ReadableKeys readableKeys(const SessionDatabase& database, const std::string& table, const std::string& column) {
  KeySearch search(database, table, column);
  // Keys are not negative; half the range suffices, and its width does not overflow.
  search.search(0, std::numeric_limits<std::int64_t>::max(), 0);
  std::vector<std::int64_t>& keys = search.found.keys;
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return std::move(search.found);
}

}  // namespace saccade
