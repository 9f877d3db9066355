#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "saccade/session/session_reader.hpp"

namespace saccade {

/// Bytes that a part of a session takes in its file.
struct PartSize {
  std::string name;
  std::int64_t bytes = 0;
};

/// The parts of a session by what they hold: map, surface volume, attend log, key frames, candidates.
[[nodiscard]] std::vector<PartSize> partSizes(const SessionReader& session);

}  // namespace saccade
