#pragma once

#include <cstdint>
#include <embree3/rtcore.h>

#include <Eigen/Core>

#include "saccade/simulation/scene.hpp"

namespace saccade {

/// The triangle that a ray meets first.
struct TriangleHit {
  std::uint32_t surface;   ///< index in Scene::surfaces(), kNoSurface if nothing is met
  std::uint32_t triangle;  ///< index in the surface's mesh
};
inline constexpr std::uint32_t kNoSurface = RTC_INVALID_GEOMETRY_ID;

/// A scene as Embree holds it. The queries may come from several threads at once; they give the same answers in every
/// run, as the tree over the triangles is built by one thread.
class EmbreeScene {
 public:
  static constexpr int kPacket = 8;

  /// Copies the vertices; keeps no reference. Throws std::runtime_error if Embree cannot work.
  explicit EmbreeScene(const Scene& scene);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// First triangles on kPacket rays from one origin.
  void castPacket(const Eigen::Vector3f& origin_W, const Eigen::Vector3f (&directions)[kPacket],
                  TriangleHit (&hits)[kPacket]) const;
  /// Whether something stands on the ray before `length_m`; the direction has unit length.
  [[nodiscard]] bool isBlocked(const Eigen::Vector3f& origin_W, const Eigen::Vector3f& direction_W,
                               float length_m) const;

 private:
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace saccade
