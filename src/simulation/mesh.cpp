#include "saccade/simulation/mesh.hpp"

namespace saccade {

void Mesh::append(const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  normals.insert(normals.end(), other.normals.begin(), other.normals.end());
  uv.insert(uv.end(), other.uv.begin(), other.uv.end());
  for (const auto& [a, b, c] : other.triangles) triangles.push_back({a + first, b + first, c + first});
}

void Mesh::transform(const Pose& motion) {
  const Eigen::Matrix3f rotation = motion.linear().cast<float>();
  for (Eigen::Vector3f& p : vertices) p = (motion * p.cast<double>()).cast<float>();
  for (Eigen::Vector3f& normal : normals) normal = rotation * normal;
}

void Mesh::scale(const Eigen::Vector3f& factors) {
  for (Eigen::Vector3f& p : vertices) p = p.cwiseProduct(factors);
  for (Eigen::Vector3f& normal : normals) normal = normal.cwiseQuotient(factors).normalized();
}

}  // namespace saccade
