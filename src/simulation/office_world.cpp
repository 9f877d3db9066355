#include "simulation/world_builder.hpp"

namespace saccade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kQuarterTurn = 1.5707963267949;

const std::vector<ObjectMaker> kPapers = {makeSheet, makeMagazine, makeSheet, makeMagazine, makeFolder, makeLyingBook};
const std::vector<ObjectMaker> kSmall = {makePen,   makeMouse,  makeRemote,   makeStapler,  makePenPot,
                                         makeMug,   makeApple,  makeTapeRoll, makePaperCup, makeGamepad,
                                         makeClock, makeCitrus, makeSmallBox, makeCan};
const std::vector<ObjectMaker> kOnTable = {makeMug,      makePaperCup, makeStorageBox, makeGamepad,   makeBottle,
                                           makePen,      makeBowl,     makeMug,        makeTelephone, makeRemote,
                                           makeCitrus,   makePenPot,   makeTissueBox,  makeParcel,    makeApple,
                                           makeKeyboard, makeMouse,    makePlate};
const std::vector<ObjectMaker> kOnCounter = {makePictureFrame, makeBrochure,  makeKeyboard, makeMug,    makeParcel,
                                             makeBottle,       makeTeapot,    makeBrochure, makeJar,    makeStorageBox,
                                             makePaperCup,     makePlate,     makeMouse,    makeMug,    makeCerealBox,
                                             makeMilkCarton,   makeCoffeeBag, makeBowl,     makeTeapot, makePenPot};
const std::vector<ObjectMaker> kStanding = {makeBrochure,     makePictureFrame, makeOpenMagazine, makeBinder,
                                            makeBrochure,     makeStandingBook, makeClock,        makePlant,
                                            makePictureFrame, makeMouse,        makeBrochure,     makeStorageBox};
const std::vector<ObjectMaker> kUpright = {makeBrochure,     makeStandingBook, makeBrochure,  makePictureFrame,
                                           makeOpenMagazine, makeBinder,       makeCerealBox, makeBrochure};
const std::vector<ObjectMaker> kOnPlinth = {makePictureFrame, makeGamepad, makeBrochure, makeMug,
                                            makeSmallBox,     makeRemote,  makeMouse,    makeClock};

/// A room with counters over a corner, a table with chairs in front of them and a shelf, and on its walls what
/// gathers on walls.
class OfficeBuilder {
 public:
  explicit OfficeBuilder(std::uint64_t seed)
      : world_(seed, Decor::paintForWork), furnish_(world_.furnisher), clutter_(world_.clutter) {}

  SimulatedWorld build(std::int64_t loop_frames) {
    world_.addRoom({0, 0}, kHigh);
    addLight();
    const Support back = furnishBackWall();
    const Support side = furnishSideWall();
    const Support shelf = furnishRightWall();
    const Support table = addTableWithChairs();
    fill(back, side, shelf, table);
    return world_.finish(lookAround(), loop_frames);
  }

 private:
  void addLight() {
    const double power = world_.random.between(0.35, 0.6);
    for (const double x : {0.3, 0.75}) {
      world_.scene().addLamp({{x * kHigh.x(), 0.5 * kHigh.y(), 2.35}, 0.45, power, 6.0});
    }
    const double daylight = world_.random.between(0.1, 0.5);
    world_.scene().addLamp({{kHigh.x() - 0.4, 3.4, 1.6}, 0.5, daylight, 6.0});
  }

  Support furnishBackWall() {
    RandomStream& random = world_.random;
    const double width = random.between(2.4, 3.0), middle = 0.62 + width / 2;
    Support counter = furnish_.addCounter({middle, 0}, 0, width);
    if (random.chance(0.6)) furnish_.addSink({middle + random.between(-0.6, 0.6), 0.34, 0.9}, 0);
    if (random.chance(0.6)) furnish_.addWallCupboards({middle, 0}, 0, width, random.between(1.45, 1.6));
    furnish_.addLeaflets({0.7 + width, 0, 1.2}, 0, -width, 5 + random.below(5));
    const double sockets_at = middle + random.between(-1.0, 1.0);
    furnish_.addSockets({sockets_at, 0, 1.12}, 0, 1 + random.below(3));
    cableAlong({middle - 0.9, 0, 1.1}, {middle + random.between(-0.5, 0.5), 0, 0.92}, 0);
    furnish_.addComputer({middle + width / 2 + 0.15, 0.03}, 0);
    return counter;
  }

  Support furnishSideWall() {
    RandomStream& random = world_.random;
    const double width = random.between(1.6, 2.2), middle = 0.62 + width / 2;
    Support counter = furnish_.addCounter({0, middle}, -kQuarterTurn, width);
    const double sockets_at = middle + random.between(-0.5, 0.5);
    furnish_.addSockets({0, sockets_at, 1.1}, -kQuarterTurn, 1 + random.below(3));
    cableAlong({0, middle + 0.5, 1.6}, {0, middle - random.between(0.0, 0.6), 0.95}, -kQuarterTurn);
    if (random.chance(0.5)) {
      furnish_.addWallScreen({0, middle + 0.1, 1.75}, -kQuarterTurn, random.between(0.7, 1.1));
    } else {
      furnish_.addLeaflets({0, middle + 0.8, 1.45}, -kQuarterTurn, 1.5, 3 + random.below(5));
    }
    const double beside = random.between(0.2, 0.3);
    furnish_.addPillar({0.15, 0.62 + width + beside}, random.between(0.2, 0.32));
    return counter;
  }

  Support furnishRightWall() {
    RandomStream& random = world_.random;
    Support shelf = furnish_.addWallShelf({kHigh.x(), 1.5, random.between(0.95, 1.15)}, kQuarterTurn, 1.8, 0.26, 0.45);
    furnish_.addWallScreen({kHigh.x(), 1.5, 1.85}, kQuarterTurn, random.between(0.9, 1.4));
    furnish_.addSockets({kHigh.x(), 1.4, 0.35}, kQuarterTurn, 2);
    for (int i = 0; i < 3; ++i) {
      const double y = random.between(0.9, 2.1), to = y + random.between(-0.2, 0.2);
      cableAlong({kHigh.x(), y, 0.9}, {kHigh.x(), to, 0.3}, kQuarterTurn);
    }
    furnish_.addRadiator({kHigh.x(), 3.2}, kQuarterTurn, 1.1);
    furnish_.addWindow({kHigh.x(), 3.2, 1.5}, kQuarterTurn, 1.2, 1.1);
    return shelf;
  }

  void cableAlong(const Vector3d& a_W, const Vector3d& b_W, double yaw) {
    if (!world_.random.chance(0.75)) return;
    const double sag = world_.random.between(0.02, 0.15);
    furnish_.addCable(a_W, b_W, yaw, sag);
  }

  Support addTableWithChairs() {
    RandomStream& random = world_.random;
    const double width = random.between(1.3, 1.8), depth = random.between(0.75, 1.0);
    const double x = random.between(2.3, 2.8), y = random.between(1.75, 2.05);
    Support table = furnish_.addTable({x, y}, 0, width, depth, random.between(0.7, 0.76));
    const bool swivel = random.chance(0.3);
    const auto chair = [&](double cx, double cy, double yaw) {
      if (!random.chance(0.8)) return;
      const double turn = yaw + random.between(-0.4, 0.4);
      if (swivel) {
        furnish_.addSwivelChair({cx, cy}, turn);
      } else {
        furnish_.addPaddedChair({cx, cy}, turn);
      }
    };
    chair(x - 0.25 * width, y - 0.55, 0);
    chair(x + 0.25 * width, y - 0.5, 0);
    chair(x - 0.3 * width, y + depth + 0.5, 2 * kQuarterTurn);
    chair(x + 0.25 * width, y + depth + 0.55, 2 * kQuarterTurn);
    chair(x - width / 2 - 0.45, y + depth / 2, -kQuarterTurn);
    return table;
  }

  void fill(const Support& back, const Support& side, const Support& shelf, const Support& table) {
    constexpr int kObjects = 70;
    RandomStream& random = world_.random;
    int placed = clutter_.fill(10, kStanding, shelf, 0.25);
    if (random.chance(0.6)) placed += clutter_.place(makeCoffeeMachine, side, 0.2) ? 1 : 0;
    if (random.chance(0.5)) placed += clutter_.place(makeToaster, back, 0.4) ? 1 : 0;
    const std::vector<const Support*> counters = {&side, &back, &back, &side, &side};
    const int plinths = 3 + random.below(3);
    for (int i = 0; i < plinths; ++i) {
      const Support* counter = counters[static_cast<std::size_t>(i)];
      placed += clutter_.placeLoaded(makePlinth, 1 + random.below(3), kOnPlinth, *counter, 0.5);
    }
    for (const Support* counter : {&side, &back, &side}) {
      placed += clutter_.stagger(2 + random.below(2), kUpright, *counter, 0.4);
    }
    placed += clutter_.scatter(7 + random.below(6), kPapers, table, 3.1);
    placed += clutter_.fill(5 + random.below(6), kOnTable, table, 1.5);
    placed += clutter_.fill(4, kStanding, back, 0.3);
    placed += clutter_.scatter(4, kPapers, back, 0.8);
    placed += clutter_.fill(9, kOnCounter, side, 0.7);
    placed += clutter_.fill(3, {makeBasket, makeParcel, makePlant}, {{3.3, 0.4, 0}, {0.9, 0.3}, 0, 2.0}, 1.0);
    // What is left are small things, which find a place anywhere.
    for (const Support* support : {&back, &table, &side}) {
      placed += clutter_.fill(support == &side ? kObjects - placed : (kObjects - placed) / 2,
                              support == &table ? kSmall : kOnCounter, *support, 1.0);
    }
  }

  std::vector<Viewpoint> lookAround() {
    const Eigen::AlignedBox3d eyes(Vector3d(1.3, 2.1, 1.3), Vector3d(3.9, 3.9, 1.7));
    const Eigen::AlignedBox3d targets(Vector3d(0.1, 0.1, 0.5), Vector3d(4.6, 2.2, 1.15));
    return wander(eyes, targets, 14, world_.random);
  }

  inline static const Vector2d kHigh{4.8, 4.2};

  WorldBuilder world_;
  Furnisher& furnish_;
  Clutter& clutter_;
};

}  // namespace

SimulatedWorld makeOfficeWorld(std::uint64_t seed, std::int64_t loop_frames) {
  return OfficeBuilder(seed).build(loop_frames);
}

}  // namespace saccade
