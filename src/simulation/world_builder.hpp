#pragma once

#include <memory>
#include <vector>

#include "saccade/simulation/simulated_world.hpp"
#include "simulation/camera_path.hpp"
#include "simulation/clutter.hpp"
#include "simulation/furniture.hpp"

namespace saccade {

/// The tools with which the kinds of scene are put together, all drawing from one seed.
class WorldBuilder {
 public:
  explicit WorldBuilder(std::uint64_t seed, Furnisher::PaintDecor paint = Decor::paint)
      : random(seed), clutter(scene_, random), furnisher(scene_, random, clutter, paint) {}

  /// Four walls around a rectangle, floor and ceiling.
  void addRoom(const Eigen::Vector2d& low, const Eigen::Vector2d& high);
  /// A ceiling lamp of the usual brightness and a weaker one that gives shadows a direction.
  void addLamps(const Eigen::Vector2d& low, const Eigen::Vector2d& high);
  [[nodiscard]] Scene& scene() { return scene_; }
  /// Hands the scene over together with its path; the builder is used up.
  [[nodiscard]] SimulatedWorld finish(std::vector<Viewpoint> turns, std::int64_t loop_frames);

 private:
  Scene scene_;

 public:
  RandomStream random;
  Clutter clutter;
  Furnisher furnisher;
};

SimulatedWorld makeDeskWorld(std::uint64_t seed, std::int64_t loop_frames);
SimulatedWorld makeCoffeeWorld(std::uint64_t seed, std::int64_t loop_frames);
SimulatedWorld makeFlatWorld(std::uint64_t seed, std::int64_t loop_frames);
SimulatedWorld makeOfficeWorld(std::uint64_t seed, std::int64_t loop_frames);
SimulatedWorld makePlainWorld(std::uint64_t seed, std::int64_t loop_frames);

}  // namespace saccade
