#pragma once

#include <cstdlib>
#include <string>

namespace saccade::test {

/// Whether a program is installed.
[[nodiscard]] inline bool hasTool(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

/// Runs a shell command, its output dropped; whether it ended with success.
[[nodiscard]] inline bool succeeds(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace saccade::test
