#pragma once

#include "session/session_database.hpp"

namespace saccade {

/// Reads every row of the tables of all parts (SessionPart) of `from`, whatever they hold, and copies them with their
/// versions to `to` unless that is null. Throws IoError for what cannot be read.
void visitPartTables(const SessionDatabase& from, SessionDatabase* to);

}  // namespace saccade
