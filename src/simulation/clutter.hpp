#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "saccade/simulation/scene.hpp"
#include "simulation/object_models.hpp"

namespace saccade {

/// A level rectangle on which things may stand.
struct Support {
  Eigen::Vector3d middle_W;
  Eigen::Vector2d half_size_m;  ///< before the turn
  double yaw = 0.0;             ///< about z; things turn their front towards its +y
  double headroom_m = 10.0;     ///< free height above it
};

/// Puts objects into a scene so that they rest on their supports and keep clear of each other and of what is blocked:
/// the outlines seen from above, convex hulls, stay a few millimetres apart wherever the heights overlap.
class Clutter {
 public:
  /// Keeps references to both.
  Clutter(Scene& scene, RandomStream& random) : scene_(scene), random_(random) {}

  /// Keeps objects out of an upright box.
  void block(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double z_low, double z_high);
  /// Makes an object and puts it somewhere on the support, its front turned by up to `spread` radians; false, and
  /// nothing is added, if no free place was found.
  bool place(ObjectMaker make, const Support& support, double spread);
  /// Places `count` objects, drawn from `makers`, large ones first; fewer only if nothing fits any more. Further
  /// books may lie on a book. Returns how many.
  int fill(int count, const std::vector<ObjectMaker>& makers, const Support& support, double spread);
  /// Lays up to `count` flat things, drawn from `makers`, about a few places of the support; they may lie over one
  /// another, as papers do. Returns how many.
  int scatter(int count, const std::vector<ObjectMaker>& makers, const Support& support, double spread);
  /// Places an even box of `base` and up to `count` things on it. Returns how many objects that makes.
  int placeLoaded(ObjectMaker base, int count, const std::vector<ObjectMaker>& makers, const Support& support,
                  double spread);
  /// Stands up to `count` things one behind the other, each partly hidden by the one in front. Returns how many.
  int stagger(int count, const std::vector<ObjectMaker>& makers, const Support& support, double spread);
  /// Stands books side by side in the middle of the support, until `count` stand or its width is used up.
  int fillWithBooks(int count, const Support& support);

 private:
  struct Outline {
    std::vector<Eigen::Vector2d> corners;  // convex, counter-clockwise
    Eigen::Vector2d low, high;
    double z_low = 0.0, z_high = 0.0;
  };

  /// Places a model and returns its pose, none if no free place was found. `allowed`: objects that may come of it,
  /// with the books on a book.
  std::optional<Pose> placeModel(const ObjectModel& model, const Support& support, double spread, int allowed);
  bool layOver(const ObjectModel& model, const Support& support, const Eigen::Vector2d& about, double reach_m,
               double spread);
  void pileBooks(const Outline& base, const Support& support, int most);
  void commit(ObjectModel model, const Outline& outline);
  [[nodiscard]] bool isFree(const Outline& outline) const;
  [[nodiscard]] static Outline outlineOf(const ObjectModel& model);
  [[nodiscard]] static bool collide(const Outline& a, const Outline& b);

  Scene& scene_;
  RandomStream& random_;
  std::vector<Outline> taken_;
};

}  // namespace saccade
