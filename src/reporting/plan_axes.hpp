#pragma once

#include <Eigen/Geometry>

namespace saccade {

/// Level directions in W as a plan has them: unit vectors to the right and ahead of the first camera.
struct PlanAxes {
  Eigen::Vector3d right, ahead;

  explicit PlanAxes(const Eigen::Vector3d& up_W) {
    right = Eigen::Vector3d::UnitZ().cross(up_W);
    constexpr double kParallel = 0.1;  // the first camera looked straight up or down, or the map is one of OctoMap's
    right = right.norm() < kParallel ? Eigen::Vector3d(Eigen::Vector3d::UnitX()) : right;
    right = (right - right.dot(up_W) * up_W).normalized();
    ahead = up_W.cross(right);
  }
};

}  // namespace saccade
