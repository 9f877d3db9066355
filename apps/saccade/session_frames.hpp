#pragma once

#include <vector>

#include <CLI/App.hpp>

#include "saccade/core/frame.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade::app {

/// How the world frame of a session B lies in that of a session A: the same, given, or to be found.
struct SessionFrames {
  std::vector<double> transform;  ///< tx ty tz qx qy qz qw, as in TUM files
  bool align = false;             ///< find it by relocalisation

  void addTo(CLI::App& command);
  [[nodiscard]] bool isSame() const { return transform.empty() && !align; }
  /// T_AB. Throws std::invalid_argument for a quaternion that is none, IoError if `b` is not found in `a`.
  [[nodiscard]] Pose resolve(const SessionReader& a, const SessionReader& b) const;
};

}  // namespace saccade::app
