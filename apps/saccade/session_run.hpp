#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_sink.hpp"
#include "saccade/sources/frame_source.hpp"

/// What explore and resume share when a run into a session begins.
namespace saccade::app {

/// The run that begins now.
[[nodiscard]] RunRecord runFrom(const std::string& input, const SourceDescription& description);

/// Throws IoError unless the session was made by the camera `found`.
void requireCamera(const SessionReader& session, const PinholeCamera& found);

/// The option --map-memory: MiB that map and surface volume may take. `from_when` ends its help.
void addMapMemory(CLI::App& command, double& limit_MiB, const std::string& from_when = "");
/// Bounds the map of a session's exploration to what --map-memory says (0: no limit).
void limitMapMemory(SessionSink& session, double limit_MiB);
/// Says what that bound did.
void sayPaging(const PagingReport& paging);

}  // namespace saccade::app
