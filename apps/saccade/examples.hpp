#pragma once

#include <CLI/App.hpp>

namespace saccade::app {

/// Puts an example or two below the help of each command that has none of its own.
void addExamples(CLI::App& program);

/// Leaves out of the help of all commands that a list is empty unless given.
void hideEmptyDefaults(CLI::App& program);

}  // namespace saccade::app
