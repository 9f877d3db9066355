#include "simulation/light_baking.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

namespace saccade {
namespace {

using Eigen::Vector3f;

constexpr int kLampRays = 10;
constexpr int kAmbientRays = 16;
constexpr float kAmbientReach_m = 0.7f;  // farther surfaces no longer darken: they send light themselves
constexpr float kAmbient = 0.42f;
constexpr float kOffset_m = 1e-3f;  // keeps a surface from shadowing itself
constexpr float kGamma = 2.2f;

/// Evenly spread over the unit disc.
template <int kCount>
std::array<Eigen::Vector2f, kCount> discPoints() {
  std::array<Eigen::Vector2f, kCount> points;
  constexpr float kGoldenAngle = 2.39996323f;
  for (int i = 0; i < kCount; ++i) {
    const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / kCount);
    const float angle = kGoldenAngle * static_cast<float>(i);
    points[static_cast<std::size_t>(i)] = {radius * std::cos(angle), radius * std::sin(angle)};
  }
  return points;
}

float lampLight(const Lamp& lamp, const EmbreeScene& rays, const Vector3f& p, const Vector3f& normal) {
  static const auto kDisc = discPoints<kLampRays>();
  const Vector3f middle = lamp.p_W.cast<float>();
  const Vector3f axis = middle - p;
  if (axis.norm() > static_cast<float>(lamp.reach_m)) return 0.0f;
  const Vector3f side = axis.unitOrthogonal(), up = axis.normalized().cross(side);
  float sum = 0.0f;
  for (const Eigen::Vector2f& point : kDisc) {
    const Vector3f target = middle + static_cast<float>(lamp.radius_m) * (point.x() * side + point.y() * up);
    const Vector3f to_lamp = target - p;
    const float distance = to_lamp.norm(), facing = normal.dot(to_lamp) / distance;
    if (facing <= 0 || rays.isBlocked(p, to_lamp / distance, distance - 2 * kOffset_m)) continue;
    // A room's walls send much of the light back: less than the square of the distance is lost.
    sum += facing / (0.5f + 0.5f * distance);
  }
  return static_cast<float>(lamp.power) * sum / kLampRays;
}

float ambientLight(const EmbreeScene& rays, const Vector3f& p, const Vector3f& normal) {
  static const auto kDisc = discPoints<kAmbientRays>();
  const Vector3f side = normal.unitOrthogonal(), up = normal.cross(side);
  int open = 0;
  for (const Eigen::Vector2f& point : kDisc) {
    const float height = std::sqrt(std::max(0.0f, 1.0f - point.squaredNorm()));
    const Vector3f direction = point.x() * side + point.y() * up + height * normal;
    open += rays.isBlocked(p, direction, kAmbientReach_m) ? 0 : 1;
  }
  constexpr float kSecondBounce = 0.25f;  // even a closed corner is not black
  return kAmbient * (kSecondBounce + (1 - kSecondBounce) * static_cast<float>(open) / kAmbientRays);
}

}  // namespace

std::vector<VertexLight> bakeLight(const Scene& scene, const EmbreeScene& rays) {
  std::vector<VertexLight> light(scene.surfaces().size());
  tbb::parallel_for(std::size_t{0}, light.size(), [&](std::size_t surface) {
    const Mesh& mesh = scene.surfaces()[surface].mesh;
    light[surface].resize(mesh.vertices.size());
    tbb::parallel_for(std::size_t{0}, mesh.vertices.size(), [&](std::size_t i) {
      const Vector3f p = mesh.vertices[i] + kOffset_m * mesh.normals[i];
      float sum = ambientLight(rays, p, mesh.normals[i]);
      for (const Lamp& lamp : scene.lamps()) sum += lampLight(lamp, rays, p, mesh.normals[i]);
      light[surface][i] = std::pow(sum, 1.0f / kGamma);
    });
  });
  return light;
}

}  // namespace saccade
