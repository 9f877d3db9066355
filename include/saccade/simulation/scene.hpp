#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

/// Surfaces with exact ray intersections. All are centred on the origin of their own frame O.
enum class Shape {
  kRectangle,  ///< in the plane z = 0, half sizes x and y, seen from both sides
  kBox,        ///< half sizes x, y and z
  kCylinder,   ///< about the z axis, with both caps: radius = half size x, half height = half size z
  kSphere,     ///< radius = half size x
};

enum class Pattern { kPlain, kChecker, kStripes, kSpeckle, kWood, kPicture };

/// Procedural texture: a function of the place on the surface in metres, nothing is stored.
struct Material {
  Pattern pattern = Pattern::kPlain;
  Eigen::Vector3f color = Eigen::Vector3f::Constant(0.6f);   ///< BGR reflectance, 0..1
  Eigen::Vector3f second = Eigen::Vector3f::Constant(0.3f);  ///< the pattern's other colour
  double scale_m = 0.1;                                      ///< size of the pattern's cells
  std::uint32_t seed = 0;                                    ///< which of the many patterns of the kind
};

struct Primitive {
  Shape shape = Shape::kBox;
  Pose T_WO = Pose::Identity();
  Eigen::Vector3d half_size_m = Eigen::Vector3d::Constant(0.1);
  Material material;
  int object_id = 0;  ///< instance that it belongs to; several primitives may form one object; 0 = background
};

/// Ray in world coordinates; the direction need not have unit length.
struct Ray {
  Eigen::Vector3d origin_W;
  Eigen::Vector3d direction_W;
};

struct SceneHit {
  double t = 0.0;  ///< p_W = origin + t * direction, t > 0
  Eigen::Vector3d p_W;
  Eigen::Vector3d normal_W;  ///< unit length, turned against the ray
  Eigen::Vector3f albedo;    ///< BGR reflectance, 0..1
  int object_id = 0;
  std::size_t primitive = 0;
};

/// A scene of primitives with one shadow-casting lamp, cast exactly: the analytic truth that tests of any stage can
/// compare with. Rendering whole images fast is SceneRenderer's business; noise is SensorNoise's.
class Scene {
 public:
  /// Appends a primitive. Throws std::invalid_argument if a size that its shape needs is not positive and finite.
  void add(const Primitive& primitive);
  /// Puts the lamp; it shines equally in all directions.
  void setLamp(const Eigen::Vector3d& p_W) { lamp_W_ = p_W; }

  [[nodiscard]] const std::vector<Primitive>& primitives() const { return primitives_; }
  [[nodiscard]] const Eigen::Vector3d& lamp() const { return lamp_W_; }

  /// Nearest surface on the ray; none if it meets nothing. Tests every primitive.
  [[nodiscard]] std::optional<SceneHit> cast(const Ray& ray) const;
  /// Depth along the optical axis that an ideal camera at T_WC measures at pixel (u, v); 0 if it sees nothing.
  [[nodiscard]] double depthAt(const PinholeCamera& camera, const Pose& T_WC, double u, double v) const;

 private:
  std::vector<Primitive> primitives_;
  Eigen::Vector3d lamp_W_ = Eigen::Vector3d(0, 0, 2);
};

}  // namespace saccade
