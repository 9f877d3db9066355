#pragma once

#include <Eigen/Geometry>

#include "saccade/core/frame.hpp"

namespace saccade {

/// Pose of something upright at `foot_W`, turned by `yaw` about z.
[[nodiscard]] inline Pose uprightPose(const Eigen::Vector3d& foot_W, double yaw) {
  Pose pose = Pose::Identity();
  pose.translate(foot_W);
  pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  return pose;
}

/// The same with its foot on the floor.
[[nodiscard]] inline Pose uprightPose(const Eigen::Vector2d& foot_W, double yaw) {
  return uprightPose(Eigen::Vector3d(foot_W.x(), foot_W.y(), 0), yaw);
}

}  // namespace saccade
