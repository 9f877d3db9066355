#include "saccade/map/view_region.hpp"

#include <stdexcept>
#include <string>

namespace saccade {

ViewRegion::ViewRegion(const PinholeCamera& camera, const Pose& T_WC, double farthest_m, double margin_m)
    : eye_W_(T_WC.translation()) {
  if (!T_WC.matrix().allFinite() || !(farthest_m >= 0.0) || !(margin_m >= 0.0)) {
    throw std::invalid_argument("ViewRegion: expected a finite pose and lengths of at least 0, found a depth of " +
                                std::to_string(farthest_m) + " m and a margin of " + std::to_string(margin_m) + " m");
  }
  // The side planes go through the eye and the outer edges of the image.
  const double left = -0.5 - camera.cx, right = camera.width - 0.5 - camera.cx;
  const double top = -0.5 - camera.cy, foot = camera.height - 0.5 - camera.cy;
  const std::array<Eigen::Vector3d, 6> normals_C = {Eigen::Vector3d(camera.fx, 0.0, -left).normalized(),
                                                    Eigen::Vector3d(-camera.fx, 0.0, right).normalized(),
                                                    Eigen::Vector3d(0.0, camera.fy, -top).normalized(),
                                                    Eigen::Vector3d(0.0, -camera.fy, foot).normalized(),
                                                    Eigen::Vector3d(0.0, 0.0, 1.0),
                                                    Eigen::Vector3d(0.0, 0.0, -1.0)};
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Eigen::Vector3d normal_W = T_WC.linear() * normals_C[i];
    sides_[i] = {normal_W, margin_m - normal_W.dot(eye_W_)};
  }
  sides_.back().offset += farthest_m;
}

bool ViewRegion::touches(const Eigen::AlignedBox3d& box_W) const {
  const Eigen::Vector3d centre = box_W.center(), half = box_W.sizes() / 2.0;
  for (const HalfSpace& side : sides_) {
    const double reach = side.normal.cwiseAbs().dot(half);  // of the box towards the inside
    if (side.normal.dot(centre) + reach + side.offset < 0.0) return false;
  }
  return true;
}

}  // namespace saccade
