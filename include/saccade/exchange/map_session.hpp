#pragma once

#include <filesystem>
#include <string>

#include "saccade/map/ior_map.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/session/session_writer.hpp"

namespace saccade {

/// Where a map without frames comes from.
struct MapOrigin {
  std::string input;        ///< as given on the command line
  std::string input_kind;   ///< for people
  std::string created_utc;  ///< ISO 8601
};

/// Writes a session that holds a map and nothing else: no frames, no camera, no surface volume. It is a start for
/// explorations with given poses, and can be inspected, viewed, exported, compared and merged. `config.map` must be the
/// map's own. Throws IoError as SessionWriter does.
void writeMapSession(const IorMap& map, ExplorerConfig config, const MapOrigin& origin,
                     const std::filesystem::path& path, WhenSessionExists when_exists);

}  // namespace saccade
