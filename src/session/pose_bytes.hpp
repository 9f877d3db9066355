#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "saccade/core/frame.hpp"

/// Poses exactly as they are: 3 x 4 float64, row by row, little-endian.
namespace saccade {

inline constexpr std::size_t kPoseBytes = 12 * sizeof(double);

[[nodiscard]] inline std::string poseBytes(const Pose& pose) {
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = pose.matrix().topRows<3>();
  return {reinterpret_cast<const char*>(rows.data()), kPoseBytes};
}

/// The pose again; none for bytes of another size, numbers that are not finite, or a matrix that is no rotation.
[[nodiscard]] inline std::optional<Pose> poseFromBytes(std::string_view bytes) {
  if (bytes.size() != kPoseBytes) return std::nullopt;
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows;
  std::memcpy(rows.data(), bytes.data(), kPoseBytes);
  constexpr double kRotationTolerance = 1e-6;  // of a product of rotations over a long run, by far
  const bool sound = rows.allFinite() && rows.leftCols<3>().isUnitary(kRotationTolerance);
  if (!sound) return std::nullopt;
  Pose pose = Pose::Identity();
  pose.matrix().topRows<3>() = rows;
  return pose;
}

}  // namespace saccade
