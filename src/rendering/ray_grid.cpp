#include "rendering/ray_grid.hpp"

#include <algorithm>
#include <cmath>

namespace saccade {

namespace {

// A camera this near to a plane between leaves, in leaves, counts as beyond it: keeps the inverse finite, and agrees
// with the leaf at k spanning [k, k + 1).
constexpr double kOnPlane = 1e-9;
// Beyond what the farthest pixel's ray reaches a leaf may still start: planes are tabulated this much farther.
constexpr double kReachMargin = 16.0;

}  // namespace

float inverseDistance(int plane, double origin) {
  const double distance = static_cast<double>(plane) - origin;
  return static_cast<float>(1.0 / (std::abs(distance) < kOnPlane ? -kOnPlane : distance));
}

bool RayGrid::prepare(const PinholeCamera& camera, const Pose& T_WC, double leaf_size_m, double near_m, double far_m) {
  preparePixels(camera, T_WC.linear());
  near = static_cast<float>(near_m / leaf_size_m);
  far = static_cast<float>(far_m / leaf_size_m);
  inverse_near = 1.0f / near;
  inverse_far = 1.0f / far;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    origin[axis] = T_WC.translation()[static_cast<Eigen::Index>(axis)] / leaf_size_m + MapTree::kCentreKey;
  }
  const double slope_x = std::max(camera.cx, camera.width - 1 - camera.cx) / camera.fx;
  const double slope_y = std::max(camera.cy, camera.height - 1 - camera.cy) / camera.fy;
  const double longest_direction = std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
  return preparePlanes((far_m / leaf_size_m + kReachMargin) * longest_direction + kReachMargin);
}

void RayGrid::preparePixels(const PinholeCamera& camera, const Eigen::Matrix3d& R_WC) {
  width = camera.width;
  height = camera.height;
  fx = static_cast<float>(camera.fx);
  fy = static_cast<float>(camera.fy);
  cx = static_cast<float>(camera.cx);
  cy = static_cast<float>(camera.cy);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    column[axis].resize(static_cast<std::size_t>(width + kPadding));
    row[axis].resize(static_cast<std::size_t>(height + kPadding));
    const double per_u = R_WC(a, 0) / camera.fx;
    const double per_v = R_WC(a, 1) / camera.fy;
    for (std::size_t u = 0; u < column[axis].size(); ++u) {
      column[axis][u] = static_cast<float>((static_cast<double>(u) - camera.cx) * per_u);
    }
    for (std::size_t v = 0; v < row[axis].size(); ++v) {
      row[axis][v] = static_cast<float>((static_cast<double>(v) - camera.cy) * per_v + R_WC(a, 2));
    }
    for (std::size_t other = 0; other < 3; ++other) {
      R_CW[axis][other] = static_cast<float>(R_WC(static_cast<Eigen::Index>(other), a));
    }
  }
  const Eigen::Vector3d inwards[4] = {{1, 0, camera.cx / camera.fx},
                                      {-1, 0, (camera.width - 1 - camera.cx) / camera.fx},
                                      {0, 1, camera.cy / camera.fy},
                                      {0, -1, (camera.height - 1 - camera.cy) / camera.fy}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3f n = inwards[i].normalized().cast<float>();
    sides[i] = {n.x(), n.y(), n.z()};
  }
}

bool RayGrid::preparePlanes(double reach) {
  constexpr double kLastPlane = 1 << MapTree::kDepth;
  for (const double o : origin) {
    if (o < -reach || o > kLastPlane + reach) return false;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    origin_key[axis] = static_cast<int>(std::floor(origin[axis]));
    origin_fraction[axis] = static_cast<float>(origin[axis] - origin_key[axis]);
    first_plane[axis] = static_cast<int>(std::clamp(origin[axis] - reach, 0.0, kLastPlane));
    const int last_plane = static_cast<int>(std::clamp(origin[axis] + reach, 0.0, kLastPlane));
    inverse_distance[axis].resize(static_cast<std::size_t>(last_plane - first_plane[axis] + 1));
    for (std::size_t i = 0; i < inverse_distance[axis].size(); ++i) {
      inverse_distance[axis][i] = inverseDistance(first_plane[axis] + static_cast<int>(i), origin[axis]);
    }
  }
  return true;
}

}  // namespace saccade
