#pragma once

#include "saccade/map/ior_map.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {

/// The whole map of a session with its attention memory at the session's last tick, under the session's own settings.
/// Throws IoError if the session's map or settings are damaged.
[[nodiscard]] IorMap loadMap(const SessionReader& session, const std::filesystem::path& path);

}  // namespace saccade
