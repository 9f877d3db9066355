#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "saccade/core/config_fields.hpp"

namespace saccade {

/// Calls a config's describe(); lets the functions below work on any Config without being templates themselves.
using DescribeConfig = std::function<void(ConfigVisitor&)>;

/// Sets fields from a YAML text whose sections and keys are those of describe(). Fields that the text does not name
/// keep their values. Throws IoError(origin, ...) that lists every unknown key and every bad value together; the
/// fields are then in an unspecified state.
void applyConfigText(const std::string& yaml, const std::filesystem::path& origin, const DescribeConfig& describe);

/// As applyConfigText, from a file. A file that cannot be read is an IoError too: it never silently means defaults.
void applyConfigFile(const std::filesystem::path& path, const DescribeConfig& describe);

/// Applies `section.key=value` settings of the command line, in order. Throws std::invalid_argument with all
/// complaints.
void applyConfigSettings(const std::vector<std::string>& settings, const DescribeConfig& describe);

/// The config as YAML. With `explain`, every field is followed by its help, unit and range as a comment. Reading the
/// result back with applyConfigText gives the same config.
[[nodiscard]] std::string printConfig(const DescribeConfig& describe, bool explain);

/// Wraps a Config object for the functions above.
template <typename Config>
[[nodiscard]] DescribeConfig describing(Config& config) {
  return [&config](ConfigVisitor& visitor) { config.describe(visitor); };
}

}  // namespace saccade
