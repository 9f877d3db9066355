#pragma once

#include <string>
#include <vector>

#include "saccade/core/frame.hpp"

namespace saccade::app {

/// The pose that an option names by seven numbers, tx ty tz qx qy qz qw as in TUM files; none: the identity. Throws
/// std::invalid_argument, naming the option, for a quaternion that is none.
[[nodiscard]] Pose givenTransform(const std::vector<double>& numbers, const std::string& option = "--transform");

}  // namespace saccade::app
