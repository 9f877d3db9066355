#include "simulation/world_builder.hpp"

namespace saccade {

void WorldBuilder::addRoom(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  furnisher.addFloorAndCeiling(low, high);
  const Eigen::Vector2d corners[] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  for (int i = 0; i < 4; ++i) furnisher.addWall(corners[i], corners[(i + 1) % 4], furnisher.decor().wall);
}

void WorldBuilder::addLamps(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d middle = 0.5 * (low + high);
  const double dx = random.between(-0.5, 0.5), dy = random.between(-0.4, 0.4), power = random.between(0.55, 0.75);
  scene_.addLamp({{middle.x() + dx, middle.y() + dy, 2.3}, 0.3, power, 6.0});
  const double side = random.chance(0.5) ? 0.2 : 0.8, z = random.between(1.6, 2.1);
  scene_.addLamp({{low.x() + side * (high.x() - low.x()), high.y() - 0.3, z}, 0.45, 0.45, 6.0});
}

SimulatedWorld WorldBuilder::finish(std::vector<Viewpoint> turns, std::int64_t loop_frames) {
  const CameraPath path(std::move(turns), loop_frames, random.bits());
  return {std::move(scene_), [path](std::int64_t frame) { return path.at(frame); }};
}

const std::vector<SceneKind>& sceneKinds() {
  static const std::vector<SceneKind> kKinds = {
      {"desk", "a desk and a shelf with 12 objects", 120, makeDeskWorld},
      {"coffee", "a kitchenette with counter, shelves and table, 80 objects in clutter", 436, makeCoffeeWorld},
      {"office", "a staff kitchen with papers over papers and much that is no object, 70 objects", 600,
       makeOfficeWorld},
      {"flat", "five rooms with 300 objects, once round and back to the start", 6000, makeFlatWorld},
      {"plain", "bare walls, which hold little for tracking", 120, makePlainWorld},
  };
  return kKinds;
}

const SceneKind* findSceneKind(const std::string& name) {
  for (const SceneKind& kind : sceneKinds()) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

}  // namespace saccade
