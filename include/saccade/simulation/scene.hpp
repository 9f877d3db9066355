#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "saccade/simulation/mesh.hpp"

namespace saccade {

/// How a surface looks and how it answers the depth sensor's infrared light.
struct Material {
  int texture = 0;     ///< index from Scene::addTexture
  float gloss = 0.0f;  ///< 0 = matt .. 1 = polished metal or glass: highlights, and no depth where it mirrors
};

/// A textured mesh in world coordinates. Several surfaces may form one object.
struct Surface {
  Mesh mesh;
  Material material;
  int object_id = 0;  ///< 0 = background: walls, posters, furniture
};

/// A soft, round lamp that faces all directions alike.
struct Lamp {
  Eigen::Vector3d p_W;
  double radius_m = 0.25;
  double power = 1.0;    ///< brightness of a white surface at 1 m, square to the light, in shares of full white
  double reach_m = 6.0;  ///< nothing farther away is lit by it
};

struct SceneObject {
  int id = 0;
  std::string kind;  ///< "mug", "book", ...
};

/// A scene of textured meshes, lamps and numbered objects: what SceneRenderer shows. World z is up, metres.
class Scene {
 public:
  /// Keeps a BGR image as texture and returns its index; repeated beyond its edges.
  int addTexture(const cv::Mat3b& image);
  /// Appends background. Throws std::invalid_argument on a mesh or material that does not fit together.
  void addBackground(Mesh mesh, const Material& material) { add({std::move(mesh), material, 0}); }
  /// Appends any surface; the same checks.
  void add(Surface surface);
  /// Numbers a new object, from 1 on.
  int addObject(std::string kind);
  /// Shifts all surfaces of an object, metres. Throws std::invalid_argument if there is no such object.
  void moveObject(int id, const Eigen::Vector3d& shift_m);
  void addLamp(const Lamp& lamp) { lamps_.push_back(lamp); }

  [[nodiscard]] const std::vector<cv::Mat3b>& textures() const { return textures_; }
  [[nodiscard]] const std::vector<Surface>& surfaces() const { return surfaces_; }
  [[nodiscard]] const std::vector<Lamp>& lamps() const { return lamps_; }
  [[nodiscard]] const std::vector<SceneObject>& objects() const { return objects_; }

 private:
  std::vector<cv::Mat3b> textures_;
  std::vector<Surface> surfaces_;
  std::vector<Lamp> lamps_;
  std::vector<SceneObject> objects_;
};

}  // namespace saccade
