#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "saccade/core/frame.hpp"

namespace saccade {

/// Triangles with shared vertices. Faces that meet in a hard edge have vertices of their own on either side.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;  ///< metres
  std::vector<Eigen::Vector3f> normals;   ///< unit length, outwards, one per vertex
  std::vector<Eigen::Vector2f> uv;        ///< one per vertex; 0..1 covers the texture once, v downwards
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::uint32_t addVertex(const Eigen::Vector3f& p, const Eigen::Vector3f& normal, const Eigen::Vector2f& uv_at_p) {
    vertices.push_back(p);
    normals.push_back(normal);
    uv.push_back(uv_at_p);
    return static_cast<std::uint32_t>(vertices.size() - 1);
  }
  void append(const Mesh& other);
  /// Moves the mesh rigidly.
  void transform(const Pose& motion);
  /// Stretches it along its axes; normals follow.
  void scale(const Eigen::Vector3f& factors);
};

}  // namespace saccade
