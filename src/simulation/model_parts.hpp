#pragma once

#include <Eigen/Geometry>

#include "saccade/simulation/mesh.hpp"
#include "simulation/random_hash.hpp"

namespace saccade {

/// What all makers of object models need.

/// A size in metres between two bounds.
[[nodiscard]] inline float size(RandomStream& random, double low_m, double high_m) {
  return static_cast<float>(random.between(low_m, high_m));
}

[[nodiscard]] inline Mesh movedTo(Mesh mesh, const Eigen::Vector3d& shift_m) {
  mesh.transform(Pose(Eigen::Translation3d(shift_m)));
  return mesh;
}

}  // namespace saccade
