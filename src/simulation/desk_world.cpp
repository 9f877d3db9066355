#include "simulation/world_builder.hpp"

namespace saccade {

SimulatedWorld makeDeskWorld(std::uint64_t seed, std::int64_t loop_frames) {
  constexpr int kObjects = 12, kOnShelf = 3;
  WorldBuilder world(seed);
  const Eigen::Vector2d low(0, 0), high(4.0, 3.8);
  world.addRoom(low, high);
  world.addLamps(low, high);
  Furnisher& furnish = world.furnisher;
  const Support desk = furnish.addTable({1.35, 0.03}, 0, 1.4, 0.68, 0.74);
  const Support shelf = furnish.addWallShelf({1.35, 0.0, 1.2}, 0, 1.1, 0.24, 0.5);
  furnish.addWardrobe({3.1, 0.02}, 0, 1.0);
  furnish.addSideboard({0.02, 1.9}, -1.5707963, 1.2);
  furnish.addChair({1.15, 1.25}, 3.1415927);
  furnish.addPoster({0.95, 0, 0.98}, 0, 0.34, 0.24);
  furnish.addPoster({1.72, 0, 0.97}, 0, 0.24, 0.26);
  furnish.addPoster({1.5, 0, 1.75}, 0, 0.6, 0.44);
  furnish.addPoster({2.3, 0, 1.25}, 0, 0.3, 0.42);
  furnish.addPoster({0, 0.75, 1.45}, -1.5707963, 0.6, 0.44);
  furnish.addPoster({0, 2.0, 1.5}, -1.5707963, 0.44, 0.6);

  Clutter& clutter = world.clutter;
  const std::vector<ObjectMaker> small = {
      makeMug,    makeBottle, makeCerealBox, makeSmallBox,  makeCan,  makeApple, makePlant,       makeTapeRoll,
      makeToyCar, makeCitrus, makeClock,     makeTissueBox, makeDuck, makeJar,   makeScrewdriver, makeBall};
  int placed = clutter.fill(kOnShelf, {makeVase, makeSmallBox, makeToyBear, makeClock}, shelf, 0.4);
  placed += clutter.place(world.random.chance(0.6) ? makeLaptop : makeKeyboard, desk, 0.25) ? 1 : 0;
  placed += clutter.place(makeTelephone, desk, 0.6) ? 1 : 0;
  // The kinds differ from seed to seed.
  std::vector<ObjectMaker> drawn;
  for (int i = 0; i < kObjects; ++i) drawn.push_back(small[static_cast<std::size_t>(world.random.below(16))]);
  clutter.fill(kObjects - placed, drawn, desk, 0.8);

  const Eigen::Vector3d middle(1.35, 0.35, 0.9);
  return world.finish(orbit(middle, 1.2, 0.5, 1.5707963, 0.5, world.random), 2 * loop_frames);
}

SimulatedWorld makePlainWorld(std::uint64_t seed, std::int64_t loop_frames) {
  WorldBuilder world(seed);
  const Eigen::Vector2d low(0, 0), high(5.0, 4.0);
  world.addRoom(low, high);
  world.addLamps(low, high);
  const Eigen::AlignedBox3d eyes(Eigen::Vector3d(1.6, 1.5, 1.3), Eigen::Vector3d(3.4, 1.9, 1.5));
  const Eigen::AlignedBox3d targets(Eigen::Vector3d(1.8, 0, 1.35), Eigen::Vector3d(3.2, 0.02, 1.5));
  return world.finish(wander(eyes, targets, 8, world.random), loop_frames);
}

}  // namespace saccade
