#pragma once

#include <vector>

#include "saccade/core/frame.hpp"

namespace saccade {

/// A pose of the colour camera at a time.
struct StampedPose {
  double stamp_s = 0.0;
  Pose T_WC = Pose::Identity();
};

/// A pose of the estimate and the true pose of the same moment.
struct PosePair {
  StampedPose estimate, truth;
};

/// Matches each pose of `truth` with the nearest of `estimate` in time; those farther apart than `max_gap_s` are left
/// out. Both by rising stamp.
[[nodiscard]] std::vector<PosePair> associate(const std::vector<StampedPose>& estimate,
                                              const std::vector<StampedPose>& truth, double max_gap_s = 0.010);

/// The rigid motion (no scale) that takes the estimate's positions closest to the true ones in the least squares sense
/// (Umeyama 1991). Identity without pairs.
[[nodiscard]] Pose alignToTruth(const std::vector<PosePair>& pairs);

/// Absolute trajectory error after alignment (Sturm et al. 2012), metres.
struct AbsoluteError {
  int matched = 0;
  double rmse_m = 0.0, mean_m = 0.0, median_m = 0.0, max_m = 0.0;
};
[[nodiscard]] AbsoluteError absoluteError(const std::vector<PosePair>& pairs);

/// Relative pose error over `delta_s` seconds (Sturm et al. 2012): drift of pairs of poses that lie that far apart in
/// time, within half the median frame interval.
struct RelativeError {
  int pairs = 0;
  double translation_rmse_m = 0.0, rotation_rmse_rad = 0.0;
};
[[nodiscard]] RelativeError relativeError(const std::vector<PosePair>& pairs, double delta_s = 1.0);

}  // namespace saccade
