#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "saccade/session/session_reader.hpp"

namespace saccade {

/// No report is larger: what goes into it is chosen within a budget for each of its sections.
constexpr std::size_t kLargestReport_bytes = 20'000'000;

/// A page (HTML) that shows a session and needs nothing else: no network, no other file, no program.
///
/// Summary, plots, key frames with the looks of that frame, objects with crops, the map reduced to points that can be
/// turned around, and all settings. `truth` (TUM format) adds the true path and the trajectory error. A session without
/// key frames (an older format, or an imported map) shows renderings of the map in their place.
///
/// Same session, same bytes; a session that is still being explored is shown as one moment of it. Throws IoError if the
/// session is damaged, `truth` cannot be read or has no pose near a frame's stamp, or gnuplot is missing.
[[nodiscard]] std::string makeSessionReport(const SessionReader& session,
                                            const std::optional<std::filesystem::path>& truth = std::nullopt);

}  // namespace saccade
