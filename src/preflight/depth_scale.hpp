#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "preflight/rigid_fit.hpp"
#include "saccade/preflight/preflight.hpp"

namespace saccade {

/// The middle one of some values, the greater of two; 0 where there is none.
[[nodiscard]] double medianOf(std::vector<double> values);

/// Median of what a depth image measured, metres; 0 where it measured nothing.
[[nodiscard]] double medianDepth(const cv::Mat1f& depth_m);

/// The likeliest number of units a metre among those in use (5000, 1000, 256, 4000, 6553.5, 10000, 1) and the declared
/// one. Three things speak: how far rooms are, how noisy depth sensors are (`fit`), and, where the input has poses,
/// how long the way between them is. `medians_m` are the frames' median depths at the declared scale.
[[nodiscard]] std::optional<DepthScaleGuess> guessDepthScale(const std::vector<double>& medians_m,
                                                             double declared_units_per_metre,
                                                             const std::optional<RigidFit>& fit);

}  // namespace saccade
