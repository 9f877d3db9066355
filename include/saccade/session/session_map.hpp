#pragma once

#include "saccade/map/ior_map.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/session/session_reader.hpp"

/// What a session holds, as the objects that it was made from. All throw IoError where the session is damaged.
namespace saccade {

/// The effective configuration of the session's last run.
[[nodiscard]] ExplorerConfig loadConfig(const SessionReader& session);

/// The map with its attention memory at the session's tick.
[[nodiscard]] IorMap loadMap(const SessionReader& session);

}  // namespace saccade
