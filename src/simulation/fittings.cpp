#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "simulation/furniture.hpp"
#include "simulation/mesh_shapes.hpp"
#include "simulation/print_paint.hpp"
#include "simulation/texture_paint.hpp"
#include "simulation/upright_pose.hpp"

namespace saccade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// A rectangle that stands in the plane y = `y` of its frame and faces +y.
Mesh standingRectangle(double left, double width, double z_low, double height, double y) {
  return makeRectangle(Vector3d(left + width, y, z_low + height).cast<float>(), Vector3d(-width, 0, 0).cast<float>(),
                       Vector3d(0, 0, -height).cast<float>(), 0.04f);
}

}  // namespace

void Furnisher::addPaddedChair(const Vector2d& back_W, double yaw) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kSize_m = 0.45, kSeat_m = 0.46, kPad_m = 0.05;
  const double height = random_.between(0.82, 0.98), post = random_.between(0.04, 0.06);
  addBox(T_WF, {0, kSize_m / 2, kSeat_m - kPad_m}, {kSize_m - 0.02, kSize_m - 0.02, kPad_m}, decor_.cloth, 0.05, 0.1f);
  addBox(T_WF, {0, kSize_m / 2, kSeat_m - kPad_m - 0.05}, {kSize_m, kSize_m, 0.05}, decor_.wood);
  for (const double x : {-0.5, 0.5}) {
    addBox(T_WF, {x * (kSize_m - post), kSize_m - post / 2, 0}, {post, post, kSeat_m - kPad_m}, decor_.wood);
    addBox(T_WF, {x * (kSize_m - post), post / 2, 0}, {post, post, height}, decor_.wood);
  }
  addBox(T_WF, {0, post / 2, height - 0.08}, {kSize_m - post, 0.03, 0.08}, decor_.wood);
  if (random_.chance(0.7)) {
    const int slats = 2 + random_.below(3);
    for (int slat = 0; slat < slats; ++slat) {
      const double z = kSeat_m + 0.06 + slat * (height - 0.16 - kSeat_m) / slats;
      addBox(T_WF, {0, post / 2, z}, {kSize_m - post, 0.02, 0.035}, decor_.wood);
    }
  } else {
    addBox(T_WF, {0, post / 2, kSeat_m + 0.08}, {kSize_m - post, 0.025, height - kSeat_m - 0.2}, decor_.cloth);
  }
  blockBox(T_WF, {0, kSize_m / 2, 0}, {kSize_m, kSize_m, height});
}

void Furnisher::addSwivelChair(const Vector2d& back_W, double yaw) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kSize_m = 0.46, kSeat_m = 0.47;
  addBox(T_WF, {0, kSize_m / 2, kSeat_m - 0.07}, {kSize_m, kSize_m, 0.07}, decor_.cloth);
  addBox(T_WF, {0, 0.03, kSeat_m + 0.1}, {0.42, 0.06, random_.between(0.35, 0.55)}, decor_.cloth);
  addBox(T_WF, {0, 0.0, kSeat_m - 0.05}, {0.06, 0.03, 0.3}, decor_.dark);
  for (const double x : {-0.27, 0.27}) {
    addBox(T_WF, {x, kSize_m / 2, kSeat_m - 0.05}, {0.03, 0.05, 0.22}, decor_.dark);
    addBox(T_WF, {x, kSize_m / 2, kSeat_m + 0.17}, {0.06, 0.26, 0.03}, decor_.dark);
  }
  Mesh stand = makeTube({{0, 0.23f, 0.1f}, {0, 0.23f, 0.4f}}, {0.03f, 0.03f});
  for (int foot = 0; foot < 5; ++foot) {
    const auto angle = static_cast<float>(2 * std::numbers::pi * foot / 5);
    const Vector3f end(0.28f * std::cos(angle), 0.23f + 0.28f * std::sin(angle), 0.05f);
    stand.append(makeTube({{0, 0.23f, 0.11f}, end}, {0.025f, 0.018f}));
    Mesh wheel = makeEllipsoid({0.028f, 0.028f, 0.028f});
    wheel.transform(Pose(Eigen::Translation3d(end.x(), end.y(), 0.0)));
    stand.append(wheel);
  }
  stand.transform(T_WF);
  scene_.addBackground(std::move(stand), {decor_.dark, 0.2f});
  blockBox(T_WF, {0, kSize_m / 2, 0}, {0.6, 0.6, 1.05});
}

void Furnisher::addLeaflets(const Vector3d& from_W, double yaw, double length_m, int count) {
  const Pose T_WF = uprightPose(from_W, yaw);
  for (int i = 0; i < count; ++i) {
    const double width = random_.between(0.1, 0.22), height = random_.between(1.2, 1.5) * width;
    const double x = -length_m * (i + random_.between(0.1, 0.9)) / count, z = random_.between(-0.08, 0.08);
    Mesh sheet = standingRectangle(x - width / 2, width, z - height / 2, height, 0.014 + 0.002 * (i % 3));
    Pose skewed = Pose::Identity();
    skewed.translate(Vector3d(x, 0, z));
    skewed.rotate(Eigen::AngleAxisd(random_.between(-0.06, 0.06), Vector3d::UnitY()));
    skewed.translate(Vector3d(-x, 0, -z));
    sheet.transform(T_WF * skewed);
    const cv::Mat3b print =
        random_.chance(0.5) ? paintDocument(width, height, random_) : paintCover(width, height, random_);
    scene_.addBackground(std::move(sheet), {scene_.addTexture(print), 0.08f});
  }
}

void Furnisher::addWallScreen(const Vector3d& middle_W, double yaw, double width_m) {
  const Pose T_WF = uprightPose(middle_W, yaw);
  const double height = 0.58 * width_m;
  addBox(T_WF, {0, 0.05, -height / 2}, {width_m, 0.06, height}, decor_.dark, 0.05, 0.2f);
  Mesh screen = standingRectangle(0.03 - width_m / 2, width_m - 0.06, 0.03 - height / 2, height - 0.06, 0.0806);
  screen.transform(T_WF);
  const cv::Mat3b shown =
      random_.chance(0.6) ? paintPoster(width_m, height, random_) : paintMottled({40, 38, 36}, 3, random_);
  scene_.addBackground(std::move(screen), {scene_.addTexture(shown), 0.6f});
  addBox(T_WF, {0, 0.01, -0.1}, {0.3, 0.02, 0.2}, decor_.dark);
}

void Furnisher::addSockets(const Vector3d& middle_W, double yaw, int count) {
  const Pose T_WF = uprightPose(middle_W, yaw);
  for (int i = 0; i < count; ++i) {
    const double x = 0.16 * (i - 0.5 * (count - 1));
    addBox(T_WF, {x, 0.018, -0.043}, {0.146, 0.012, 0.086}, decor_.ceiling, 0.04, 0.15f);
    if (random_.chance(0.5)) addBox(T_WF, {x + 0.03, 0.042, -0.025}, {0.045, 0.036, 0.05}, decor_.dark);
  }
}

void Furnisher::addCable(const Vector3d& a_W, const Vector3d& b_W, double yaw, double sag_m) {
  const Vector3d outward(-std::sin(yaw), std::cos(yaw), 0);
  std::vector<Vector3f> path;
  for (int i = 0; i <= 12; ++i) {
    const double t = i / 12.0, sway = 0.01 * std::sin(7 * t + sag_m * 40);
    const Vector3d p =
        (1 - t) * a_W + t * b_W + (0.014 + sway * sway) * outward - Vector3d(0, 0, 4 * sag_m * t * (1 - t));
    path.push_back(p.cast<float>());
  }
  scene_.addBackground(makeTube(path, std::vector<float>(path.size(), 0.004f), 6),
                       {random_.chance(0.6) ? decor_.dark : decor_.ceiling, 0.05f});
}

void Furnisher::addPillar(const Vector2d& middle_W, double width_m) {
  const Pose T_WF = uprightPose(middle_W, 0);
  addBox(T_WF, {0, 0, 0}, {width_m, width_m, 2.5}, decor_.ceiling, 0.06);
  addBox(T_WF, {0, 0, 0}, {width_m + 0.024, width_m + 0.024, 0.1}, decor_.steel, 0.05, 0.1f);
  blockBox(T_WF, {0, 0, 0}, {width_m, width_m, 2.5});
}

void Furnisher::addRadiator(const Vector2d& back_W, double yaw, double width_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  addBox(T_WF, {0, 0.05, 0.14}, {width_m, 0.02, 0.56}, decor_.ceiling);
  const int ribs = static_cast<int>(width_m / 0.07);
  for (int rib = 0; rib < ribs; ++rib) {
    addBox(T_WF, {-width_m / 2 + (rib + 0.5) * width_m / ribs, 0.08, 0.12}, {0.035, 0.05, 0.6}, decor_.ceiling, 0.04,
           0.1f);
  }
  addBox(T_WF, {width_m / 2 + 0.03, 0.08, 0.66}, {0.05, 0.05, 0.05}, decor_.steel);
  blockBox(T_WF, {0, 0.06, 0}, {width_m + 0.1, 0.12, 0.75});
}

void Furnisher::addComputer(const Vector2d& back_W, double yaw) {
  const Pose T_WF = uprightPose(back_W, yaw);
  const double height = random_.between(0.36, 0.45);
  addBox(T_WF, {0, 0.22, 0}, {0.18, 0.44, height}, random_.chance(0.6) ? decor_.dark : decor_.steel);
  addBox(T_WF, {0, 0.445, height - 0.07}, {0.15, 0.01, 0.04}, decor_.steel, 0.04, 0.2f);
  addBox(T_WF, {0, 0.445, 0.06}, {0.13, 0.01, 0.16}, decor_.dark, 0.04, 0.2f);
  blockBox(T_WF, {0, 0.22, 0}, {0.18, 0.46, height});
}

void Furnisher::addSink(const Vector3d& middle_W, double yaw) {
  const Pose T_WF = uprightPose(middle_W, yaw);
  constexpr double kWidth_m = 0.5, kDepth_m = 0.4;
  addBox(T_WF, {0, 0, 0}, {kWidth_m, kDepth_m, 0.004}, decor_.steel, 0.02, 0.5f);
  // The basin is shown by its dark ground; a rim stands about it.
  addBox(T_WF, {-0.05, 0.02, 0.004}, {0.32, 0.28, 0.001}, decor_.dark, 0.02, 0.6f);
  for (const double side : {-1.0, 1.0}) {
    addBox(T_WF, {side * kWidth_m / 2, 0, 0}, {0.012, kDepth_m, 0.008}, decor_.steel, 0.04, 0.5f);
    addBox(T_WF, {0, side * kDepth_m / 2, 0}, {kWidth_m, 0.012, 0.008}, decor_.steel, 0.04, 0.5f);
  }
  std::vector<Vector3f> spout;
  for (int i = 0; i <= 8; ++i) {
    const auto angle = static_cast<float>(std::numbers::pi * i / 8);
    spout.emplace_back(0.0f, -0.15f + 0.07f * (1 - std::cos(angle)), 0.2f + 0.07f * std::sin(angle));
  }
  spout.insert(spout.begin(), {0.0f, -0.15f, 0.0f});
  Mesh tap = makeTube(spout, std::vector<float>(spout.size(), 0.012f));
  tap.transform(T_WF);
  scene_.addBackground(std::move(tap), {decor_.steel, 0.7f});
  blockBox(T_WF, {0, 0, 0}, {kWidth_m, kDepth_m, 0.3});
}

void Furnisher::addWallCupboards(const Vector2d& back_W, double yaw, double width_m, double z_low_m) {
  const Pose T_WF = uprightPose(back_W, yaw);
  constexpr double kDepth_m = 0.33, kHeight_m = 0.7;
  addBox(T_WF, {0, kDepth_m / 2, z_low_m}, {width_m, kDepth_m, kHeight_m}, decor_.dark);
  const int doors = std::max(1, static_cast<int>(width_m / 0.5));
  for (int door = 0; door < doors; ++door) {
    const double x = -width_m / 2 + (door + 0.5) * width_m / doors;
    addBox(T_WF, {x, kDepth_m + 0.01, z_low_m}, {width_m / doors - 0.006, 0.02, kHeight_m}, decor_.board, 0.05, 0.15f);
    addBox(T_WF, {x, kDepth_m + 0.03, z_low_m + 0.05}, {0.2, 0.02, 0.012}, decor_.steel, 0.05, 0.4f);
  }
}

void Furnisher::addWindow(const Vector3d& middle_W, double yaw, double width_m, double height_m) {
  const Pose T_WF = uprightPose(middle_W, yaw);
  Mesh pane = standingRectangle(-width_m / 2, width_m, -height_m / 2, height_m, 0.006);
  pane.transform(T_WF);
  scene_.addBackground(std::move(pane), {scene_.addTexture(paintMottled({250, 248, 240}, 6, random_)), 0.9f});
  for (const double x : {-0.5, 0.0, 0.5})
    addBox(T_WF, {x * width_m, 0.02, -height_m / 2}, {0.05, 0.04, height_m}, decor_.ceiling);
  for (const double z : {-0.5, 0.5})
    addBox(T_WF, {0, 0.02, z * height_m - 0.025}, {width_m, 0.04, 0.05}, decor_.ceiling);
  if (random_.chance(0.6)) {
    const int slats = static_cast<int>(random_.between(0.4, 1.0) * height_m / 0.05);
    for (int slat = 0; slat < slats; ++slat)
      addBox(T_WF, {0, 0.06, height_m / 2 - 0.05 * (slat + 1)}, {width_m, 0.03, 0.006}, decor_.board);
  }
}

}  // namespace saccade
