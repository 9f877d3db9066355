#pragma once

#include <filesystem>

namespace saccade {

/// Writes the objects of a session into its tables `objects` and `object_looks`, in place of those that are there, so
/// that any SQLite program can ask for them. One transaction. Saccade itself finds objects anew from the attend log,
/// which is never out of date. The number of objects. Throws IoError if another program is writing to the session.
int storeObjects(const std::filesystem::path& session);

}  // namespace saccade
