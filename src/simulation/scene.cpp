#include "saccade/simulation/scene.hpp"

#include <stdexcept>

namespace saccade {

int Scene::addTexture(const cv::Mat3b& image) {
  if (image.empty()) throw std::invalid_argument("Scene: expected a texture with pixels, found an empty image");
  textures_.push_back(image);
  return static_cast<int>(textures_.size()) - 1;
}

void Scene::add(Surface surface) {
  const Mesh& mesh = surface.mesh;
  const std::size_t count = mesh.vertices.size();
  if (mesh.normals.size() != count || mesh.uv.size() != count) {
    throw std::invalid_argument("Scene: expected " + std::to_string(count) +
                                " normals and texture coordinates, found " + std::to_string(mesh.normals.size()) +
                                " and " + std::to_string(mesh.uv.size()));
  }
  for (const Eigen::Vector3f& p : mesh.vertices) {
    if (!p.allFinite()) throw std::invalid_argument("Scene: expected finite vertices, found one that is not");
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner < count) continue;
      throw std::invalid_argument("Scene: expected corners below " + std::to_string(count) + ", found " +
                                  std::to_string(corner));
    }
  }
  const int textures = static_cast<int>(textures_.size());
  if (surface.material.texture < 0 || surface.material.texture >= textures) {
    throw std::invalid_argument("Scene: expected one of " + std::to_string(textures) + " textures, found number " +
                                std::to_string(surface.material.texture));
  }
  if (surface.object_id < 0 || surface.object_id > static_cast<int>(objects_.size())) {
    throw std::invalid_argument("Scene: expected one of " + std::to_string(objects_.size()) +
                                " objects, found number " + std::to_string(surface.object_id));
  }
  surfaces_.push_back(std::move(surface));
}

int Scene::addObject(std::string kind) {
  objects_.push_back({static_cast<int>(objects_.size()) + 1, std::move(kind)});
  return objects_.back().id;
}

void Scene::moveObject(int id, const Eigen::Vector3d& shift_m) {
  if (id < 1 || id > static_cast<int>(objects_.size())) {
    throw std::invalid_argument("Scene: expected one of " + std::to_string(objects_.size()) +
                                " objects, found number " + std::to_string(id));
  }
  const Eigen::Vector3f shift = shift_m.cast<float>();
  for (Surface& surface : surfaces_) {
    if (surface.object_id != id) continue;
    for (Eigen::Vector3f& vertex : surface.mesh.vertices) vertex += shift;
  }
}

}  // namespace saccade
