#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "saccade/core/frame.hpp"
#include "saccade/exchange/map_merge.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_writer.hpp"

namespace saccade {

/// What merging two sessions did.
struct SessionMergeReport {
  MapMergeReport map;
  std::int64_t leaves = 0;
  std::int64_t bricks = 0;
  std::int64_t frames = 0;
  std::int64_t keyframes = 0;
  std::uint32_t tick = 0;
};

/// Writes the session that `a` and `b` make together, in the world frame and under the settings of `a`; `T_AB` takes
/// points of b's world frame to a's.
///
/// Map and attention as mergeMaps() has it; surface volumes are averaged by weight. Runs, frames, candidates and
/// keyframes of `a` come first, those of `b` after them with their poses taken to a's frame; the attend logs follow one
/// another, b's ticks counted on from a's last. Objects are found in the joined log, so what both sessions attended in
/// one place is one object. Nothing of either session is left out. Throws IoError as SessionReader and SessionWriter
/// do.
SessionMergeReport mergeSessions(const SessionReader& a, const SessionReader& b, const Pose& T_AB,
                                 const std::filesystem::path& path, WhenSessionExists when_exists,
                                 const std::string& created_utc);

}  // namespace saccade
