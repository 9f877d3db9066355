#pragma once

#include <vector>

#include "saccade/inspection/view_server.hpp"

namespace saccade::app {

/// The page of `saccade view` as it was built into the program. Throws IoError that says what was missing if this
/// program was built without it.
[[nodiscard]] std::vector<PageFile> viewPage();

}  // namespace saccade::app
