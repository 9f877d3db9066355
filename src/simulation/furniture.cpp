#include "simulation/furniture.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "simulation/mesh_shapes.hpp"
#include "simulation/print_paint.hpp"
#include "simulation/texture_paint.hpp"
#include "simulation/upright_pose.hpp"

namespace saccade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kRoomHeight_m = 2.5, kLintel_m = 2.05;
constexpr double kRoomCell_m = 0.08;     // walls and ceilings, where light changes slowly
constexpr double kSurfaceCell_m = 0.02;  // where things stand and cast their shadows
constexpr double kTile_m = 0.9;          // one repeat of a texture

Mesh tiledRectangle(const Vector3d& corner, const Vector3d& right, const Vector3d& down, double cell_m,
                    double tile_m = kTile_m) {
  return makeRectangle(corner.cast<float>(), right.cast<float>(), down.cast<float>(), static_cast<float>(cell_m),
                       {0, 0, static_cast<float>(right.norm() / tile_m), static_cast<float>(down.norm() / tile_m)});
}

}  // namespace

Decor Decor::paint(Scene& scene, RandomStream& random) {
  static const cv::Scalar kWalls[] = {{205, 218, 222}, {190, 208, 202}, {212, 212, 206}, {178, 205, 220}};
  static const cv::Scalar kWoods[] = {{95, 140, 185}, {65, 105, 150}, {130, 170, 205}, {50, 75, 110}};
  Decor decor{};
  decor.wall = scene.addTexture(paintMottled(kWalls[random.below(4)], 7, random));
  decor.floor = scene.addTexture(paintWood(kWoods[random.below(4)] * 0.8, random));
  decor.ceiling = scene.addTexture(paintMottled({228, 230, 230}, 4, random));
  decor.wood = scene.addTexture(paintWood(kWoods[random.below(4)], random));
  decor.board = scene.addTexture(paintMottled({212, 216, 218}, 5, random));
  decor.stone =
      scene.addTexture(paintStone(random.chance(0.5) ? cv::Scalar(120, 125, 128) : cv::Scalar(170, 185, 195), random));
  decor.tiles = scene.addTexture(paintTiles(quietColor(random) * 0.5 + cv::Scalar::all(110), random));
  decor.cloth = scene.addTexture(paintCloth(random));
  decor.dark = scene.addTexture(paintMottled({62, 60, 60}, 8, random));
  decor.steel = scene.addTexture(paintMottled({160, 163, 165}, 8, random));
  return decor;
}

Decor Decor::paintForWork(Scene& scene, RandomStream& random) {
  static const cv::Scalar kWoods[] = {{95, 140, 185}, {35, 52, 80}, {130, 170, 205}, {50, 75, 110}};
  static const cv::Scalar kFloors[] = {{110, 95, 85}, {95, 95, 95}, {120, 130, 140}, {70, 75, 85}};
  Decor decor{};
  decor.wall = scene.addTexture(paintMottled(quietColor(random) * 0.4 + cv::Scalar::all(125), 5, random));
  const cv::Scalar floor = kFloors[random.below(4)];
  decor.floor = scene.addTexture(random.chance(0.75) ? paintCarpet(floor, random) : paintStone(floor, random));
  decor.ceiling = scene.addTexture(paintMottled({228, 230, 230}, 4, random));
  decor.wood = scene.addTexture(paintWood(kWoods[random.below(4)], random));
  decor.board = scene.addTexture(paintMottled(anyColor(random, 0.5) * 0.85, 4, random));
  decor.stone =
      scene.addTexture(paintStone(random.chance(0.6) ? cv::Scalar(48, 46, 45) : cv::Scalar(150, 160, 168), random));
  decor.stone_gloss = static_cast<float>(random.between(0.2, 0.8));
  const cv::Scalar tiles = quietColor(random) * 0.5 + cv::Scalar::all(80);
  decor.tiles = scene.addTexture(paintTiles(tiles, random, 4 << random.below(3)));
  decor.cloth =
      scene.addTexture(random.chance(0.6) ? paintMottled(quietColor(random) * 0.7, 9, random) : paintCloth(random));
  decor.dark = scene.addTexture(paintMottled({48, 46, 46}, 8, random));
  decor.steel = scene.addTexture(paintMottled({160, 163, 165}, 8, random));
  return decor;
}

void Furnisher::addBox(const Pose& T_WF, const Vector3d& foot_F, const Vector3d& size_m, int texture, double cell_m,
                       float gloss) {
  Mesh mesh = makeTiledBox(size_m.cast<float>(), static_cast<float>(kTile_m), static_cast<float>(cell_m));
  mesh.transform(T_WF * Eigen::Translation3d(foot_F));
  scene_.addBackground(std::move(mesh), {texture, gloss});
}

void Furnisher::blockBox(const Pose& T_WF, const Vector3d& foot_F, const Vector3d& size_m) {
  Eigen::AlignedBox3d box;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      box.extend(T_WF * (foot_F + Vector3d(x * size_m.x(), y * size_m.y(), 0)));
      box.extend(T_WF * (foot_F + Vector3d(x * size_m.x(), y * size_m.y(), size_m.z())));
    }
  }
  clutter_.block(box.min().head<2>(), box.max().head<2>(), box.min().z(), box.max().z());
}

void Furnisher::addFloorAndCeiling(const Vector2d& low, const Vector2d& high) {
  const Vector2d size = high - low;
  scene_.addBackground(tiledRectangle({low.x(), high.y(), 0}, {size.x(), 0, 0}, {0, -size.y(), 0}, 0.04, 1.1),
                       {decor_.floor, 0.08f});
  scene_.addBackground(tiledRectangle({high.x(), high.y(), kRoomHeight_m}, {-size.x(), 0, 0}, {0, -size.y(), 0}, 0.2),
                       {decor_.ceiling, 0.0f});
}

void Furnisher::addWall(const Vector2d& a, const Vector2d& b, int texture, const std::vector<Doorway>& doorways) {
  const double length = (b - a).norm();
  const Vector2d along = (b - a) / length;
  const auto piece = [&](double from, double to, double z_low, double z_high) {
    // Seen from the left of a-b, b is to the left.
    const Vector2d corner = a + to * along, right = (from - to) * along;
    scene_.addBackground(tiledRectangle({corner.x(), corner.y(), z_high}, {right.x(), right.y(), 0},
                                        {0, 0, z_low - z_high}, kRoomCell_m),
                         {texture, 0.0f});
    if (z_low > 0) return;
    const double yaw = std::atan2(along.y(), along.x());
    const Vector2d middle = a + 0.5 * (from + to) * along;
    addBox(uprightPose(middle, yaw), {0, 0.008, 0}, {to - from, 0.016, 0.09}, decor_.board, 0.1);
  };
  double at = 0.0;
  for (const Doorway& door : doorways) {
    piece(at, door.from_m, 0, kRoomHeight_m);
    piece(door.from_m, door.to_m, kLintel_m, kRoomHeight_m);
    const Pose T_WF = uprightPose(a, std::atan2(along.y(), along.x()));
    for (const double edge : {door.from_m, door.to_m})
      addBox(T_WF, {edge, -0.03, 0}, {0.09, 0.1, kLintel_m}, decor_.board);
    addBox(T_WF, {0.5 * (door.from_m + door.to_m), -0.03, kLintel_m - 0.03}, {door.to_m - door.from_m, 0.1, 0.09},
           decor_.board);
    at = door.to_m;
  }
  piece(at, length, 0, kRoomHeight_m);
}

void Furnisher::addPoster(const Vector3d& middle_W, double yaw, double width_m, double height_m) {
  const Pose T_WF = uprightPose(middle_W, yaw);
  addBox(T_WF, {0, 0.009, -height_m / 2}, {width_m, 0.018, height_m}, random_.chance(0.5) ? decor_.dark : decor_.wood);
  Mesh picture =
      makeRectangle(Vector3d(width_m / 2 - 0.02, 0.0185, height_m / 2 - 0.02).cast<float>(),
                    Vector3d(0.04 - width_m, 0, 0).cast<float>(), Vector3d(0, 0, 0.04 - height_m).cast<float>(), 0.05f);
  picture.transform(T_WF);
  scene_.addBackground(std::move(picture), {scene_.addTexture(paintPoster(width_m, height_m, random_)), 0.1f});
}

Support Furnisher::addTable(const Vector2d& back_W, double yaw, double width_m, double depth_m, double height_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kTop_m = 0.03, kLeg_m = 0.05;
  addBox(T_WF, {0, depth_m / 2, height_m - kTop_m}, {width_m, depth_m, kTop_m}, decor_.wood, kSurfaceCell_m, 0.06f);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {0.05, depth_m - 0.05}) {
      const Vector3d foot(x * (width_m / 2 - 0.05), y, 0), size(kLeg_m, kLeg_m, height_m - kTop_m);
      addBox(T_WF, foot, size, decor_.wood);
      blockBox(T_WF, foot, size);
    }
  }
  return {T_WF * Vector3d(0, depth_m / 2, height_m), {width_m / 2, depth_m / 2}, yaw, 0.9};
}

Support Furnisher::addCounter(const Vector2d& back_W, double yaw, double width_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kDepth_m = 0.6, kHeight_m = 0.9, kTop_m = 0.04, kDoor_m = 0.5;
  addBox(T_WF, {0, 0.29, 0.08}, {width_m, 0.56, kHeight_m - kTop_m - 0.08}, decor_.dark);
  addBox(T_WF, {0, 0.26, 0}, {width_m, 0.5, 0.08}, decor_.dark);
  const int doors = std::max(1, static_cast<int>(width_m / kDoor_m));
  const double step = width_m / doors;
  for (int door = 0; door < doors; ++door) {
    const double x = -width_m / 2 + (door + 0.5) * step;
    const bool drawers = door % 3 == 1;
    const int fronts = drawers ? 3 : 1;
    const double height = (kHeight_m - kTop_m - 0.1) / fronts;
    for (int front = 0; front < fronts; ++front) {
      const double z = 0.09 + front * height;
      addBox(T_WF, {x, 0.58, z}, {step - 0.008, 0.02, height - 0.008}, decor_.board);
      const Vector3d handle =
          drawers ? Vector3d(x, 0.6, z + 0.6 * height) : Vector3d(x + 0.4 * step, 0.6, z + 0.65 * height);
      addBox(T_WF, handle, drawers ? Vector3d(0.16, 0.02, 0.012) : Vector3d(0.012, 0.02, 0.14), decor_.steel, 0.05,
             0.4f);
    }
  }
  addBox(T_WF, {0, kDepth_m / 2, kHeight_m - kTop_m}, {width_m, kDepth_m, kTop_m}, decor_.stone, kSurfaceCell_m,
         decor_.stone_gloss);
  addBox(T_WF, {0, 0.006, kHeight_m}, {width_m, 0.012, 0.4}, decor_.tiles, 0.04, 0.2f);
  blockBox(T_WF, {0, kDepth_m / 2, 0}, {width_m, kDepth_m, kHeight_m});
  return {T_WF * Vector3d(0, kDepth_m / 2 + 0.01, kHeight_m), {width_m / 2, kDepth_m / 2 - 0.015}, yaw, 0.42};
}

Support Furnisher::addWallShelf(const Vector3d& back_W, double yaw, double width_m, double depth_m, double headroom_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  addBox(T_WF, {0, depth_m / 2, -0.025}, {width_m, depth_m, 0.025}, decor_.wood, kSurfaceCell_m, 0.06f);
  for (const double x : {-0.35, 0.35}) {
    addBox(T_WF, {x * width_m, 0.35 * depth_m, -0.055}, {0.02, 0.7 * depth_m, 0.03}, decor_.dark);
  }
  return {back_W + T_WF.linear() * Vector3d(0, depth_m / 2, 0), {width_m / 2, depth_m / 2}, yaw, headroom_m};
}

std::vector<Support> Furnisher::addBookcase(const Vector2d& back_W, double yaw, double width_m, double height_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kDepth_m = 0.3, kBoard_m = 0.022, kLevel_m = 0.36;
  const int texture = random_.chance(0.5) ? decor_.wood : decor_.board;
  std::vector<Support> boards;
  addBox(T_WF, {0, 0.01, 0}, {width_m, 0.02, height_m}, texture, 0.04);  // hides the skirting
  for (const double x : {-0.5, 0.5}) {
    addBox(T_WF, {x * (width_m - kBoard_m), kDepth_m / 2, 0}, {kBoard_m, kDepth_m, height_m}, texture, 0.04);
  }
  const int levels = static_cast<int>((height_m - 0.08) / kLevel_m);
  for (int level = 0; level <= levels; ++level) {
    const double z = level == levels ? height_m - kBoard_m : 0.06 + level * (height_m - 0.08) / levels;
    addBox(T_WF, {0, kDepth_m / 2, z}, {width_m - 2 * kBoard_m, kDepth_m - 0.004, kBoard_m}, texture, kSurfaceCell_m);
    const double headroom = level == levels ? 0.5 : (height_m - 0.08) / levels - kBoard_m - 0.03;
    boards.push_back({T_WF * Vector3d(0, kDepth_m / 2 + 0.008, z + kBoard_m),
                      {width_m / 2 - kBoard_m - 0.003, kDepth_m / 2 - 0.014},
                      yaw,
                      headroom});
  }
  blockBox(T_WF, {0, kDepth_m / 2, 0}, {width_m, kDepth_m, 0.05});
  return boards;
}

Support Furnisher::addSideboard(const Vector2d& back_W, double yaw, double width_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kDepth_m = 0.42, kHeight_m = 0.8;
  addBox(T_WF, {0, kDepth_m / 2, 0.06}, {width_m, kDepth_m, kHeight_m - 0.06}, decor_.wood, kSurfaceCell_m, 0.06f);
  addBox(T_WF, {0, kDepth_m / 2, 0}, {width_m - 0.1, kDepth_m - 0.08, 0.06}, decor_.dark);
  for (const double x : {-0.25, 0.25}) {
    addBox(T_WF, {x * width_m, kDepth_m + 0.006, 0.1}, {0.47 * width_m, 0.012, 0.64}, decor_.board);
    addBox(T_WF, {0.16 * x * width_m, kDepth_m + 0.022, 0.4}, {0.015, 0.02, 0.12}, decor_.steel, 0.05, 0.4f);
  }
  blockBox(T_WF, {0, kDepth_m / 2, 0}, {width_m, kDepth_m + 0.03, kHeight_m});
  return {T_WF * Vector3d(0, kDepth_m / 2, kHeight_m), {width_m / 2, kDepth_m / 2}, yaw, 0.8};
}

void Furnisher::addWardrobe(const Vector2d& back_W, double yaw, double width_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kDepth_m = 0.55, kHeight_m = 2.0;
  addBox(T_WF, {0, kDepth_m / 2, 0}, {width_m, kDepth_m, kHeight_m}, decor_.wood);
  for (const double x : {-0.25, 0.25}) {
    addBox(T_WF, {x * width_m, kDepth_m + 0.008, 0.08}, {0.48 * width_m, 0.016, kHeight_m - 0.14}, decor_.board);
    addBox(T_WF, {0.16 * x * width_m, kDepth_m + 0.025, 0.95}, {0.015, 0.02, 0.2}, decor_.steel, 0.05, 0.4f);
  }
  blockBox(T_WF, {0, kDepth_m / 2, 0}, {width_m, kDepth_m + 0.04, kHeight_m});
}

Support Furnisher::addSofa(const Vector2d& back_W, double yaw, double width_m, bool deep) {
  const Pose T_WF = uprightPose(back_W, yaw);
  const double depth_m = deep ? 1.9 : 0.85, seat_m = 0.44, arm_m = deep ? 0.05 : 0.16;
  addBox(T_WF, {0, depth_m / 2, 0.08}, {width_m, depth_m, seat_m - 0.08}, decor_.cloth, 0.03);
  addBox(T_WF, {0, 0.1, seat_m}, {width_m, 0.2, deep ? 0.5 : 0.4}, deep ? decor_.wood : decor_.cloth, 0.04);
  if (!deep) {
    for (const double x : {-0.5, 0.5}) {
      addBox(T_WF, {x * (width_m - arm_m), depth_m / 2, seat_m}, {arm_m, depth_m, 0.17}, decor_.cloth, 0.04);
    }
  }
  blockBox(T_WF, {0, depth_m / 2, 0}, {width_m, depth_m, seat_m});
  return {T_WF * Vector3d(0, depth_m / 2 + 0.1, seat_m), {width_m / 2 - arm_m, depth_m / 2 - 0.11}, yaw, 0.8};
}

void Furnisher::addChair(const Vector2d& back_W, double yaw) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kSize_m = 0.42, kSeat_m = 0.45;
  addBox(T_WF, {0, kSize_m / 2, kSeat_m - 0.03}, {kSize_m, kSize_m, 0.03}, decor_.wood);
  for (const double x : {-0.18, 0.18}) {
    addBox(T_WF, {x, kSize_m - 0.03, 0}, {0.035, 0.035, kSeat_m - 0.03}, decor_.wood);
    addBox(T_WF, {x, 0.02, 0}, {0.035, 0.035, 0.9}, decor_.wood);
  }
  for (const double z : {0.6, 0.72, 0.84}) addBox(T_WF, {0, 0.02, z}, {0.33, 0.018, 0.06}, decor_.wood);
  blockBox(T_WF, {0, kSize_m / 2, 0}, {kSize_m, kSize_m, 0.9});
}

}  // namespace saccade
