#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "saccade/evaluation/trajectory_error.hpp"
#include "saccade/inspection/timeline.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {

/// The session's path beside the true one.
struct TruthComparison {
  std::vector<PosePair> pairs;
  Pose alignment = Pose::Identity();  ///< takes W to the frame of the truth
  AbsoluteError error;
};

/// A plot on a page.
struct ReportPlot {
  std::string title, svg, caption;
};

/// The plots of a session, those without data left out: path from above, trajectory error, candidates, revisits, IOR
/// weights, stage times, memory. Each has some hundred points a line at most, however long the session is.
[[nodiscard]] std::vector<ReportPlot> plotSession(const SessionReader& session,
                                                  const std::vector<TimelineEntry>& timeline, const IorMap& map,
                                                  const AttendLog& log, const Eigen::Vector3d& up_W,
                                                  const std::optional<TruthComparison>& truth);

}  // namespace saccade
