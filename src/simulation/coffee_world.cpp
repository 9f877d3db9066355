#include "simulation/world_builder.hpp"

namespace saccade {
namespace {

constexpr double kQuarterTurn = 1.5707963267949;

const std::vector<ObjectMaker> kOnCounter = {makeTeapot,    makeCerealBox, makeMilkCarton, makeBottle, makeMug,
                                             makeCan,       makeJar,       makeBowl,       makePlate,  makeSprayBottle,
                                             makeCoffeeBag, makeSmallBox,  makeApple,      makeCitrus, makeBanana,
                                             makePear,      makeTissueBox, makeMug,        makeBottle, makeCan};
const std::vector<ObjectMaker> kOnShelf = {makeJar,    makeCan,       makeCoffeeBag, makeMug,
                                           makeBottle, makeSmallBox,  makePlant,     makeBowl,
                                           makeTeapot, makeCerealBox, makeVase,      makeMilkCarton};
const std::vector<ObjectMaker> kOnTable = {makeLyingBook, makeMug,    makeToyCar,   makeBowl,        makeBottle,
                                           makeApple,     makeDuck,   makeToyBear,  makeScrewdriver, makeHammer,
                                           makeTapeRoll,  makeBricks, makePlant,    makeCerealBox,   makeBall,
                                           makeCitrus,    makeClock,  makeTelephone};

}  // namespace

SimulatedWorld makeCoffeeWorld(std::uint64_t seed, std::int64_t loop_frames) {
  constexpr int kObjects = 80;
  WorldBuilder world(seed);
  const Eigen::Vector2d low(0, 0), high(4.4, 3.8);
  world.addRoom(low, high);
  world.addLamps(low, high);
  Furnisher& furnish = world.furnisher;
  const Support counter = furnish.addCounter({2.1, 0.0}, 0, 2.4);
  const Support lower = furnish.addWallShelf({2.1, 0.0, 1.38}, 0, 2.1, 0.26, 0.32);
  const Support upper = furnish.addWallShelf({2.1, 0.0, 1.74}, 0, 2.1, 0.26, 0.36);
  const Support table = furnish.addTable({0.02, 1.55}, -kQuarterTurn, 1.3, 0.8, 0.74);
  furnish.addWardrobe({3.85, 0.0}, 0, 0.9);
  furnish.addChair({1.25, 1.75}, kQuarterTurn);
  furnish.addPoster({0.45, 0, 1.5}, 0, 0.5, 0.66);
  furnish.addPoster({0, 1.25, 1.45}, -kQuarterTurn, 0.5, 0.4);
  furnish.addPoster({0, 2.0, 1.5}, -kQuarterTurn, 0.42, 0.6);

  Clutter& clutter = world.clutter;
  const Support floor{{2.0, 1.0, 0}, {1.1, 0.3}, 0, 2.0};
  int placed = clutter.place(makeCoffeeMachine, counter, 0.15) ? 1 : 0;
  placed += clutter.place(makeToaster, counter, 0.4) ? 1 : 0;
  placed += clutter.fill(6, {makeBasket, makePlant, makeBall, makeToyCar, makeTapeRoll, makeSmallBox}, floor, 1.0);
  placed += clutter.fill(24, kOnTable, table, 1.2);
  placed += clutter.fill(12, kOnShelf, lower, 0.4);
  placed += clutter.fill(8, kOnShelf, upper, 0.4);
  // The counter takes the rest: it is where the clutter is.
  clutter.fill(kObjects - placed, kOnCounter, counter, 0.7);

  // Past the counter, over to the table and back.
  std::vector<Viewpoint> turns = orbit({2.05, 0.25, 1.15}, 1.75, 0.42, 1.45, 0.42, world.random);
  const std::vector<Viewpoint> aside = orbit({0.9, 0.85, 0.92}, 1.8, 0.55, 0.75, 0.2, world.random);
  turns.insert(turns.end(), aside.begin(), aside.begin() + 7);
  return world.finish(std::move(turns), loop_frames);
}

}  // namespace saccade
