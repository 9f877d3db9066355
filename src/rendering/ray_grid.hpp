#pragma once

#include <array>
#include <vector>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/map_cursor.hpp"

namespace saccade {

/// Rays of all pixels and planes between all leaves in range, for one pose.
///
/// Lengths are in leaves, positions in continuous keys (leaf k spans [k, k + 1)). The ray of pixel (u, v) is
/// origin + z * direction, z the depth along the optical axis. A plane between leaves, at distance b from the origin
/// along its axis, is met at z = b / direction, so that *inverse* depth 1 / z = direction * (1 / b) is a product of
/// something per pixel and something per plane: no division per pixel and leaf. Both leaves at a plane use the same
/// product, so no ray slips between them, whatever the rounding.
struct RayGrid {
  static constexpr int kPadding = 8;  ///< more entries in `column` and `row` than pixels: windows may hang over

  int width = 0, height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  /// direction[axis] of pixel (u, v) = column[axis][u] + row[axis][v], frame W.
  std::array<std::vector<float>, 3> column, row;
  std::array<std::array<float, 3>, 3> R_CW{};

  std::array<double, 3> origin{};          ///< camera centre
  std::array<int, 3> origin_key{};         ///< its leaf
  std::array<float, 3> origin_fraction{};  ///< origin - origin_key
  float near = 0, far = 0;                 ///< depth along the optical axis
  float inverse_near = 0, inverse_far = 0;

  std::array<int, 3> first_plane{};                    ///< key of the first plane of the table below
  std::array<std::vector<float>, 3> inverse_distance;  ///< 1 / b of plane first_plane + i; never infinite

  /// Image borders as planes through the camera centre, unit normals inwards, frame C.
  std::array<std::array<float, 3>, 4> sides{};

  /// Fills all of it. Returns false if no leaf of the map can be in range: the camera is too far from the key space.
  [[nodiscard]] bool prepare(const PinholeCamera& camera, const Pose& T_WC, double leaf_size_m, double near_m,
                             double far_m);

 private:
  void preparePixels(const PinholeCamera& camera, const Eigen::Matrix3d& R_WC);
  bool preparePlanes(double reach);
};

/// 1 / (plane - origin) as all parts of the renderer round it. A camera on the plane counts as just beyond it.
[[nodiscard]] float inverseDistance(int plane, double origin);

}  // namespace saccade
