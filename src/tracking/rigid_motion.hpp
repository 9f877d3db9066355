#pragma once

#include <Eigen/Geometry>

#include "saccade/core/frame.hpp"

namespace saccade {

/// The motion that turns by the rotation vector `turn` (radians) and then shifts by `shift` (metres). For the small
/// steps of an iteration it stands in for the exponential map of SE(3), from which it differs in second order.
inline Pose rigidMotion(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
  Pose motion = Pose::Identity();
  const double angle = turn.norm();
  if (angle > 0.0) motion.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  motion.translation() = shift;
  return motion;
}

/// Rotation vector (radians) of a rotation matrix.
inline Eigen::Vector3d rotationVector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(rotation).normalized());
  return turn.angle() * turn.axis();
}

/// `pose` with its rotation made orthonormal again, after many products.
inline Pose orthonormalized(const Pose& pose) {
  Pose clean = Pose::Identity();
  clean.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  clean.translation() = pose.translation();
  return clean;
}

}  // namespace saccade
