#include "saccade/simulation/scene.hpp"

#include <stdexcept>
#include <string>

#include "simulation/primitive_geometry.hpp"

namespace saccade {

void Scene::add(const Primitive& primitive) {
  const Eigen::Vector3d half = enclosingHalfSize(primitive);
  const int needed = primitive.shape == Shape::kRectangle ? 2 : 3;
  for (int axis = 0; axis < needed; ++axis) {
    if (half[axis] > 0 && std::isfinite(half[axis])) continue;
    throw std::invalid_argument("Scene: expected positive finite half sizes, found " + std::to_string(half[axis]));
  }
  primitives_.push_back(primitive);
}

std::optional<SceneHit> Scene::cast(const Ray& ray) const {
  SceneHit hit;
  hit.t = kNoHit;
  for (std::size_t i = 0; i < primitives_.size(); ++i) {
    const Primitive& primitive = primitives_[i];
    const Eigen::Matrix3d R_OW = primitive.T_WO.linear().transpose();
    const double t = intersect(primitive.shape, primitive.half_size_m,
                               R_OW * (ray.origin_W - primitive.T_WO.translation()), R_OW * ray.direction_W);
    if (t < hit.t) {
      hit.t = t;
      hit.primitive = i;
    }
  }
  if (hit.t == kNoHit) return std::nullopt;
  const Primitive& primitive = primitives_[hit.primitive];
  hit.p_W = ray.origin_W + hit.t * ray.direction_W;
  const Eigen::Vector3d p_O = primitive.T_WO.inverse() * hit.p_W;
  const Eigen::Vector3d normal_O = outwardNormal(primitive.shape, primitive.half_size_m, p_O);
  hit.normal_W = primitive.T_WO.linear() * normal_O;
  if (hit.normal_W.dot(ray.direction_W) > 0) hit.normal_W = -hit.normal_W;
  hit.albedo = albedoAt(primitive, p_O, normal_O);
  hit.object_id = primitive.object_id;
  return hit;
}

double Scene::depthAt(const PinholeCamera& camera, const Pose& T_WC, double u, double v) const {
  // The ray reaches z = 1 at t = 1, so t is the depth along the axis.
  const std::optional<SceneHit> hit = cast({T_WC.translation(), T_WC.linear() * camera.unproject(u, v, 1.0)});
  return hit ? hit->t : 0.0;
}

}  // namespace saccade
