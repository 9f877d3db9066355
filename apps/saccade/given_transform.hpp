#pragma once

#include <vector>

#include "saccade/core/frame.hpp"

namespace saccade::app {

/// The pose that `--transform` names by seven numbers, tx ty tz qx qy qz qw as in TUM files; none: the identity. Throws
/// std::invalid_argument for a quaternion that is none.
[[nodiscard]] Pose givenTransform(const std::vector<double>& numbers);

}  // namespace saccade::app
