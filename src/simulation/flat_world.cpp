#include "simulation/world_builder.hpp"

namespace saccade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kQuarterTurn = 1.5707963267949;

struct Room {
  Vector2d low, high;  // inside the walls
};

// Three rooms in the upper row, two in the lower; doors lead once round: study, living room, kitchen, bedroom,
// workshop.
const Room kStudy{{0.06, 4.06}, {3.94, 7.94}}, kLiving{{4.06, 4.06}, {8.94, 7.94}},
    kKitchen{{9.06, 4.06}, {12.94, 7.94}}, kBedroom{{6.56, 0.06}, {12.94, 3.94}}, kWorkshop{{0.06, 0.06}, {6.44, 3.94}};
constexpr double kDoor_m = 0.9;

const std::vector<ObjectMaker> kHousehold = {
    makeMug,      makeBottle, makeCan,    makeSmallBox, makeLyingBook, makePlant,     makeApple,
    makeJar,      makeVase,   makeToyCar, makeDuck,     makeBall,      makeToyBear,   makeBricks,
    makeTapeRoll, makeClock,  makeBowl,   makeCitrus,   makeTissueBox, makeTelephone, makeCoffeeBag};
const std::vector<ObjectMaker> kFood = {makeTeapot, makeCerealBox, makeMilkCarton, makeBottle,   makeMug,
                                        makeCan,    makeJar,       makeBowl,       makePlate,    makeApple,
                                        makeBanana, makePear,      makeCitrus,     makeCoffeeBag};
const std::vector<ObjectMaker> kTools = {makeHammer, makeScrewdriver, makeTapeRoll, makeSprayBottle, makeSmallBox,
                                         makeCan,    makeJar,         makeBricks,   makeToyCar,      makeBottle};
const std::vector<ObjectMaker> kOnFloor = {makeBasket,    makeBall,   makePlant, makeToyBear,
                                           makeCerealBox, makeToyCar, makeBricks};

class FlatBuilder {
 public:
  explicit FlatBuilder(std::uint64_t seed) : world_(seed), furnish_(world_.furnisher), clutter_(world_.clutter) {}

  SimulatedWorld build(std::int64_t loop_frames) {
    addShell();
    furnishStudy();
    furnishLiving();
    furnishKitchen();
    furnishBedroom();
    furnishWorkshop();
    fillUp();
    return world_.finish(roundTrip(), loop_frames);
  }

 private:
  void addWalls(const Room& room, const std::vector<std::vector<Doorway>>& doorways) {
    const Vector2d corners[] = {room.low, {room.high.x(), room.low.y()}, room.high, {room.low.x(), room.high.y()}};
    for (std::size_t i = 0; i < 4; ++i) {
      furnish_.addWall(corners[i], corners[(i + 1) % 4], furnish_.decor().wall, doorways[i]);
    }
    world_.addLamps(room.low, room.high);
  }

  /// A door in the wall that starts at `start` and runs in the direction `sign` of an axis, centred at `place`.
  static std::vector<Doorway> doorAt(double start, double sign, double place) {
    const double middle = sign * (place - start);
    return {{middle - kDoor_m / 2, middle + kDoor_m / 2}};
  }

  // Walls in order: lower, right, upper, left, each run with the room on its left.
  void addShell() {
    furnish_.addFloorAndCeiling({0, 0}, {13, 8});
    addWalls(kStudy, {doorAt(kStudy.low.x(), 1, 2.6), doorAt(kStudy.low.y(), 1, 5.2), {}, {}});
    addWalls(kLiving, {{}, doorAt(kLiving.low.y(), 1, 5.2), {}, doorAt(kLiving.high.y(), -1, 5.2)});
    addWalls(kKitchen, {doorAt(kKitchen.low.x(), 1, 10.2), {}, {}, doorAt(kKitchen.high.y(), -1, 5.2)});
    addWalls(kBedroom, {{}, {}, doorAt(kBedroom.high.x(), -1, 10.2), doorAt(kBedroom.high.y(), -1, 2.6)});
    addWalls(kWorkshop, {{}, doorAt(kWorkshop.low.y(), 1, 2.6), doorAt(kWorkshop.high.x(), -1, 2.6), {}});
  }

  void addPosters(const Room& room, const std::vector<double>& x_on_upper, bool on_upper) {
    const double y = on_upper ? room.high.y() : room.low.y(), yaw = on_upper ? 2 * kQuarterTurn : 0;
    for (const double x : x_on_upper) {
      const double width = world_.random.between(0.35, 0.7), height = world_.random.between(0.35, 0.6);
      furnish_.addPoster({x, y, 1.62}, yaw, width, height);
    }
  }

  /// Pictures on the left or right wall.
  void addSidePosters(const Room& room, const std::vector<double>& y_on_wall, bool on_right) {
    const double x = on_right ? room.high.x() : room.low.x(), yaw = on_right ? kQuarterTurn : -kQuarterTurn;
    for (const double y : y_on_wall) {
      const double width = world_.random.between(0.4, 0.8), height = world_.random.between(0.35, 0.6);
      furnish_.addPoster({x, y, 1.55}, yaw, width, height);
    }
  }

  /// A few things per board, books on some.
  void fillBookcase(const std::vector<Support>& boards, int per_board) {
    for (std::size_t i = 0; i < boards.size(); ++i) {
      int left = per_board;
      if (i % 2 == 0 && i + 1 < boards.size()) left -= clutter_.fillWithBooks(per_board - 2, boards[i]);
      clutter_.fill(left, kHousehold, boards[i], 0.3);
    }
  }

  void furnishStudy() {
    const Support desk = furnish_.addTable({1.6, kStudy.high.y() - 0.02}, 2 * kQuarterTurn, 1.6, 0.75, 0.74);
    clutter_.place(makeLaptop, desk, 0.2);
    clutter_.fill(15, kHousehold, desk, 0.8);
    furnish_.addChair({1.6, 6.4}, 0.1);
    fillBookcase(furnish_.addBookcase({kStudy.low.x(), 6.0}, -kQuarterTurn, 1.4, 1.9), 4);
    fillBookcase(furnish_.addBookcase({3.2, kStudy.high.y()}, 2 * kQuarterTurn, 1.0, 1.5), 3);
    addPosters(kStudy, {0.9, 1.7}, true);
    addPosters(kStudy, {0.8, 1.5}, false);
    addSidePosters(kStudy, {6.4, 7.3}, true);
    addSidePosters(kStudy, {4.6}, false);
    clutter_.fill(3, kOnFloor, {{0.9, 4.7, 0}, {0.7, 0.5}, 0, 2.0}, 1.5);
  }

  void furnishLiving() {
    const Support sofa = furnish_.addSofa({6.3, kLiving.high.y() - 0.02}, 2 * kQuarterTurn, 2.0, false);
    clutter_.fill(4, {makeToyBear, makeBall, makeLyingBook, makeTissueBox}, sofa, 1.0);
    const Support low_table = furnish_.addTable({6.3, 6.35}, 0, 1.1, 0.6, 0.44);
    clutter_.fill(13, kHousehold, low_table, 1.5);
    const Support board = furnish_.addSideboard({6.2, kLiving.low.y()}, 0, 1.8);
    clutter_.fill(15, kHousehold, board, 0.6);
    fillBookcase(furnish_.addBookcase({8.3, kLiving.high.y()}, 2 * kQuarterTurn, 1.1, 1.9), 4);
    addPosters(kLiving, {5.6, 6.6}, true);
    addPosters(kLiving, {5.5, 6.3, 7.6}, false);
    addSidePosters(kLiving, {6.3, 7.2}, true);
    addSidePosters(kLiving, {6.4}, false);
    clutter_.fill(3, kOnFloor, {{4.6, 7.3, 0}, {0.4, 0.5}, 0, 2.0}, 1.5);
  }

  void furnishKitchen() {
    const Support counter = furnish_.addCounter({11.2, kKitchen.high.y()}, 2 * kQuarterTurn, 2.6);
    clutter_.place(makeCoffeeMachine, counter, 0.2);
    clutter_.place(makeToaster, counter, 0.3);
    clutter_.fill(24, kFood, counter, 0.7);
    const Support shelf = furnish_.addWallShelf({11.2, kKitchen.high.y(), 1.42}, 2 * kQuarterTurn, 2.2, 0.26, 0.4);
    clutter_.fill(12, {makeJar, makeCan, makeCoffeeBag, makeMug, makeBowl, makePlant, makeBottle}, shelf, 0.4);
    const Support table = furnish_.addTable({kKitchen.high.x() - 0.02, 5.6}, kQuarterTurn, 1.2, 0.8, 0.74);
    clutter_.fill(17, kFood, table, 1.4);
    furnish_.addChair({11.8, 5.2}, -kQuarterTurn);
    addPosters(kKitchen, {11.5, 12.3}, false);
    addSidePosters(kKitchen, {5.0, 6.0, 7.0}, true);
    addSidePosters(kKitchen, {6.4}, false);
  }

  void furnishBedroom() {
    const Support bed = furnish_.addSofa({11.6, kBedroom.low.y()}, 0, 1.6, true);
    clutter_.fill(6, {makeToyBear, makeLyingBook, makeTissueBox, makeBall}, bed, 1.5);
    furnish_.addWardrobe({9.6, kBedroom.low.y()}, 0, 1.2);
    const Support board = furnish_.addSideboard({8.0, kBedroom.low.y()}, 0, 1.4);
    clutter_.fill(13, kHousehold, board, 0.6);
    fillBookcase(furnish_.addBookcase({7.6, kBedroom.high.y()}, 2 * kQuarterTurn, 1.2, 1.5), 4);
    const Support table = furnish_.addTable({12.4, kBedroom.high.y() - 0.02}, 2 * kQuarterTurn, 0.9, 0.5, 0.74);
    clutter_.fill(8, kHousehold, table, 0.8);
    addPosters(kBedroom, {7.3, 8.4, 11.5}, false);
    addSidePosters(kBedroom, {1.0, 2.2, 3.2}, true);
    addSidePosters(kBedroom, {1.3, 3.5}, false);
    clutter_.fill(4, kOnFloor, {{7.4, 0.9, 0}, {0.5, 0.2}, 0, 2.0}, 1.5);
  }

  void furnishWorkshop() {
    const Support bench = furnish_.addTable({3.0, kWorkshop.low.y()}, 0, 2.4, 0.7, 0.88);
    clutter_.fill(22, kTools, bench, 1.3);
    const Support shelf = furnish_.addWallShelf({3.0, kWorkshop.low.y(), 1.4}, 0, 2.0, 0.28, 0.6);
    clutter_.fill(11, {makeCan, makeJar, makeSmallBox, makeSprayBottle, makeBottle, makeTapeRoll}, shelf, 0.5);
    fillBookcase(furnish_.addBookcase({kWorkshop.low.x(), 2.3}, -kQuarterTurn, 1.4, 1.5), 4);
    const Support side = furnish_.addSideboard({5.4, kWorkshop.low.y()}, 0, 1.4);
    clutter_.fill(12, kHousehold, side, 0.8);
    addPosters(kWorkshop, {1.2, 5.4}, false);
    addPosters(kWorkshop, {0.9, 3.8, 5.2}, true);
    addSidePosters(kWorkshop, {0.9}, true);
    addSidePosters(kWorkshop, {0.8, 3.4}, false);
    clutter_.fill(4, kOnFloor, {{0.9, 0.8, 0}, {0.7, 0.5}, 0, 2.0}, 1.5);
    spare_ = {bench, side, shelf};
  }

  /// Whatever found no place elsewhere stands in the workshop, where there is room; the count is always the same.
  void fillUp() {
    constexpr int kObjects = 300;
    for (const Support& support : spare_) {
      const int missing = kObjects - static_cast<int>(world_.scene().objects().size());
      if (missing > 0) clutter_.fill(missing, kTools, support, 3.0);
    }
  }

  /// Through the five rooms: each is looked over from a few places, doors are passed looking ahead.
  std::vector<Viewpoint> roundTrip() {
    const double z = 1.45;
    const auto at = [z](double x, double y, double target_x, double target_y, double target_z) {
      return Viewpoint{{x, y, z}, {target_x, target_y, target_z}};
    };
    std::vector<Viewpoint> turns = {
        // study, from the workshop's door
        at(2.6, 4.6, 1.9, 7.7, 0.9), at(2.4, 5.4, 1.5, 7.7, 0.8), at(1.9, 5.7, 0.6, 7.2, 0.9),
        at(1.8, 5.6, 0.2, 6.0, 1.0), at(2.0, 5.9, 0.6, 7.2, 0.9), at(2.2, 6.0, 1.8, 7.6, 0.8),
        at(2.4, 5.8, 3.2, 7.7, 0.9), at(2.8, 5.3, 4.5, 6.8, 0.9), at(3.6, 5.2, 5.6, 6.0, 0.9),
        // living room
        at(4.4, 5.2, 6.4, 6.2, 0.7), at(5.0, 5.4, 6.4, 6.8, 0.5), at(5.6, 5.5, 6.6, 7.4, 0.6),
        at(6.4, 5.6, 7.6, 7.5, 0.9), at(7.2, 5.8, 8.4, 7.7, 1.0), at(7.6, 5.9, 8.9, 6.8, 1.0),
        at(7.9, 5.8, 8.9, 5.4, 0.9), at(7.8, 5.8, 7.6, 4.2, 0.9), at(7.3, 5.9, 6.2, 4.2, 0.8),
        at(7.0, 5.8, 6.4, 4.2, 0.8), at(7.4, 5.5, 8.0, 4.2, 0.9), at(8.0, 5.3, 9.6, 4.8, 0.9),
        at(8.6, 5.2, 10.6, 5.5, 0.9),
        // kitchen
        at(9.4, 5.2, 10.8, 6.5, 0.9), at(10.0, 5.6, 11.0, 7.7, 1.0), at(10.3, 6.1, 10.9, 7.8, 1.05),
        at(10.8, 6.1, 11.8, 7.8, 1.05), at(10.9, 5.8, 12.6, 6.9, 0.9), at(10.7, 5.4, 12.6, 5.6, 0.8),
        at(10.5, 5.3, 12.2, 4.6, 0.9), at(10.3, 5.1, 11.0, 3.4, 0.9), at(10.2, 4.4, 10.4, 2.4, 0.9),
        // bedroom
        at(10.2, 3.6, 10.8, 1.6, 0.7), at(10.2, 2.9, 11.6, 1.2, 0.6), at(10.0, 2.7, 11.8, 2.2, 0.6),
        at(10.0, 2.7, 11.4, 0.8, 0.6), at(9.6, 2.6, 9.8, 0.4, 0.9), at(9.0, 2.4, 8.4, 0.3, 0.9),
        at(8.7, 2.2, 7.6, 0.4, 0.8), at(8.6, 2.0, 6.8, 1.4, 0.9), at(8.7, 2.1, 6.9, 2.9, 0.9),
        at(8.6, 2.3, 7.4, 3.8, 0.9), at(8.2, 2.4, 6.6, 3.2, 0.9), at(7.4, 2.6, 5.4, 2.4, 0.9),
        at(6.5, 2.6, 4.6, 1.8, 0.9),
        // workshop
        at(5.6, 2.5, 4.6, 0.6, 0.9), at(5.0, 2.2, 4.2, 0.3, 1.0), at(4.2, 2.0, 3.6, 0.2, 1.0),
        at(3.4, 1.9, 2.8, 0.2, 1.0), at(2.6, 1.9, 1.9, 0.3, 0.9), at(2.1, 2.0, 0.8, 0.9, 0.7),
        at(1.9, 2.2, 0.2, 2.2, 0.9), at(2.1, 2.5, 0.6, 3.7, 1.0), at(2.4, 3.0, 1.8, 5.2, 0.9),
        at(2.6, 3.8, 2.4, 6.2, 0.9)};
    for (Viewpoint& view : turns) {
      for (int axis = 0; axis < 3; ++axis) {
        const double eye = world_.random.between(-0.05, 0.05), target = world_.random.between(-0.1, 0.1);
        view.eye_W[axis] += eye;
        view.target_W[axis] += target;
      }
    }
    return turns;
  }

  WorldBuilder world_;
  Furnisher& furnish_;
  Clutter& clutter_;
  std::vector<Support> spare_;
};

}  // namespace

SimulatedWorld makeFlatWorld(std::uint64_t seed, std::int64_t loop_frames) {
  return FlatBuilder(seed).build(loop_frames);
}

}  // namespace saccade
