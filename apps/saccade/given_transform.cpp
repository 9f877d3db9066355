#include "given_transform.hpp"

#include <cmath>
#include <stdexcept>

namespace saccade::app {

Pose givenTransform(const std::vector<double>& numbers, const std::string& option) {
  if (numbers.empty()) return Pose::Identity();
  const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
  constexpr double kRounding = 1e-3;  // of numbers typed from a file
  if (!(std::abs(q.norm() - 1.0) < kRounding)) {
    throw std::invalid_argument(option + " expects tx ty tz qx qy qz qw with a quaternion of length 1, found length " +
                                std::to_string(q.norm()));
  }
  return Pose(Eigen::Translation3d(numbers[0], numbers[1], numbers[2]) * q.normalized());
}

}  // namespace saccade::app
