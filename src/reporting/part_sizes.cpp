#include "reporting/part_sizes.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <utility>

#include "session/session_database.hpp"

namespace saccade {

std::vector<PartSize> partSizes(const SessionReader& session) {
  constexpr std::pair<const char*, const char*> kParts[] = {
      {"map", "SELECT sum(length(data)) FROM tiles"},
      {"surface volume", "SELECT sum(length(data)) FROM bricks"},
      {"attend log", "SELECT sum(length(data)) FROM attend_log"},
      {"key frames", "SELECT sum(length(color) + length(depth) + length(features)) FROM keyframes"},
      {"candidates", "SELECT sum(length(mask) + length(features)) FROM candidates"},
  };
  const SessionDatabase& database = session.database();
  return database.use("a whole Saccade session", [&] {
    std::vector<PartSize> sizes;
    for (const auto& [name, query] : kParts) sizes.push_back({name, database.sqlite().execAndGet(query).getInt64()});
    return sizes;
  });
}

}  // namespace saccade
