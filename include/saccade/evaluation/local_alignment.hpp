#pragma once

#include <vector>

#include "saccade/evaluation/trajectory_error.hpp"

namespace saccade {

/// Takes true poses into the world of an estimated trajectory, each by the frames that looked from nearby.
///
/// One rigid motion for the whole trajectory (`alignToTruth`) leaves the estimate's own drift in what it takes over: a
/// place that is found exactly in a map that bends by 5 cm counts as 5 cm off. Here a pose keeps its true motion
/// relative to the frames nearest to it, so that what remains is the error of the place itself and the truth's noise.
class LocalAlignment {
 public:
  /// Frames that a pose is carried by: enough to average the truth's noise, few enough to be near.
  static constexpr std::size_t kNearest = 5;

  /// `pairs`: one or more.
  /// @throws std::invalid_argument without pairs
  explicit LocalAlignment(std::vector<PosePair> pairs);

  /// T_WC in the world of the estimate, where `truth` is the pose in the world of the truth: the mean of what the
  /// kNearest frames say. Near are frames whose cameras and whose view, 2 m ahead, are close.
  [[nodiscard]] Pose toEstimate(const Pose& truth) const;

 private:
  std::vector<PosePair> pairs_;
};

}  // namespace saccade
