#pragma once

#include <string>

#include "saccade/core/camera.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/sources/frame_source.hpp"

/// What explore and resume share when a run into a session begins.
namespace saccade::app {

/// The run that begins now.
[[nodiscard]] RunRecord runFrom(const std::string& input, const SourceDescription& description);

/// Throws IoError unless the session was made by the camera `found`.
void requireCamera(const SessionReader& session, const PinholeCamera& found);

}  // namespace saccade::app
