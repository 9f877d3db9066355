#pragma once

#include <Eigen/Core>

namespace saccade {

/// Pinhole camera without distortion: pixel centres at integers, (u, v) = (column, row), x right, y down, z forward.
///
/// Inputs with lens distortion are undistorted when they are read (sources/), so no later stage sees distortion.
struct PinholeCamera {
  int width = 0;
  int height = 0;
  double fx = 0.0, fy = 0.0;  ///< focal lengths, pixels
  double cx = 0.0, cy = 0.0;  ///< principal point, pixels

  /// Pixel of a camera-frame point with z > 0.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_C) const {
    return {fx * p_C.x() / p_C.z() + cx, fy * p_C.y() / p_C.z() + cy};
  }

  /// Camera-frame point at depth `z_m` (along the optical axis, not along the ray) behind the pixel.
  [[nodiscard]] Eigen::Vector3d unproject(double u, double v, double z_m) const {
    return {(u - cx) / fx * z_m, (v - cy) / fy * z_m, z_m};
  }

  /// The camera of an image reduced by the whole number `factor`, whose pixel (u, v) averages or samples the block
  /// that starts at (factor * u, factor * v); block centres map to pixel centres.
  [[nodiscard]] PinholeCamera reducedBy(int factor) const {
    const double f = factor;
    return {width / factor, height / factor, fx / f, fy / f, (cx + 0.5) / f - 0.5, (cy + 0.5) / f - 0.5};
  }

  friend bool operator==(const PinholeCamera&, const PinholeCamera&) = default;
};

}  // namespace saccade
