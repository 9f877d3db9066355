#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "saccade/session/session_records.hpp"

namespace saccade {

/// The rows of the meta table: each value is JSON.
[[nodiscard]] std::map<std::string, std::string> metadataToText(const SessionMetadata& metadata);

/// The metadata again. Throws IoError(path, ...) that names a key that is missing or of the wrong kind.
[[nodiscard]] SessionMetadata metadataFromText(const std::map<std::string, std::string>& rows,
                                               const std::filesystem::path& path);

}  // namespace saccade
