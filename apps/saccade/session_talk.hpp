#pragma once

#include <ostream>

#include "saccade/session/session_repair.hpp"

namespace saccade::app {

/// A table of what is whole and what is not, and the complaints.
void printFindings(const SessionFindings& findings, std::ostream& out);

/// Whether anything is wrong.
[[nodiscard]] bool isWhole(const SessionFindings& findings);

}  // namespace saccade::app
