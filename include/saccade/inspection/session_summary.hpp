#pragma once

#include <cstdint>
#include <vector>

#include "saccade/session/session_reader.hpp"

namespace saccade {

/// What a session holds, in numbers.
struct SessionSummary {
  SessionMetadata metadata;
  std::vector<RunRecord> runs;
  std::int64_t file_bytes = 0;
  std::int64_t frames = 0, tracked = 0, weak = 0, lost = 0;
  std::int64_t keyframes = 0;
  std::int64_t attended = 0;    ///< candidates
  double path_length_m = 0.0;   ///< of the camera, over the frames that have a pose
  double covered_s = 0.0;       ///< time of the inputs from each run's first frame to its last
  double mean_open = 0.0;       ///< candidates a frame
  double mean_inhibited = 0.0;  ///< candidates a frame
  double median_ms = 0.0;       ///< processing time a frame
  double first_stamp_s = 0.0;
  double last_stamp_s = 0.0;
};

/// Summary of a session whose frames are `frames`; the map is not loaded.
[[nodiscard]] SessionSummary summarise(const SessionReader& session, const std::vector<FrameRecord>& frames);

}  // namespace saccade
