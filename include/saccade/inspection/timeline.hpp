#pragma once

#include <vector>

#include "saccade/map/attend_log.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {

/// One frame with what attention did in it.
struct TimelineEntry {
  FrameRecord frame;
  int revisits = 0;   ///< attended candidates of which at least half was attended before
  int flags_on = 0;   ///< leaves that began to inhibit
  int forgotten = 0;  ///< leaves that turned free while they were remembered

  /// Share of the attended candidates that are revisits; 0 without any.
  [[nodiscard]] double revisitRate() const {
    return frame.attended > 0 ? static_cast<double>(revisits) / frame.attended : 0.0;
  }
};

/// The frames of a session, `log` its attend log, in the order of processing.
[[nodiscard]] std::vector<TimelineEntry> timelineOf(const SessionReader& session, const AttendLog& log);

}  // namespace saccade
