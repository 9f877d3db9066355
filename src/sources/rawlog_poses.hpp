#pragma once

#include <mrpt/poses/CPose3D.h>

#include "saccade/core/frame.hpp"

namespace saccade {

/// MRPT's range cameras R look along +x with y to the left and z up; takes points of the optical frame to R.
[[nodiscard]] inline Pose opticalInRangeCamera() {
  Pose T_RD = Pose::Identity();
  T_RD.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T_RD;
}

[[nodiscard]] inline Pose fromMrpt(const mrpt::poses::CPose3D& pose) {
  Pose T = Pose::Identity();
  const auto rotation = pose.getRotationMatrix();
  for (int i = 0; i < 9; ++i) T.linear()(i / 3, i % 3) = rotation(i / 3, i % 3);
  T.translation() = Eigen::Vector3d(pose.x(), pose.y(), pose.z());
  return T;
}

[[nodiscard]] inline mrpt::poses::CPose3D toMrpt(const Pose& T) {
  mrpt::math::CMatrixDouble44 matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = T.matrix()(i / 4, i % 4);
  return mrpt::poses::CPose3D(matrix);
}

}  // namespace saccade
