#include <cmath>

#include "simulation/mesh_shapes.hpp"
#include "simulation/model_parts.hpp"
#include "simulation/object_models.hpp"
#include "simulation/print_paint.hpp"
#include "simulation/texture_paint.hpp"

namespace saccade {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kQuarterTurn = 3.14159265358979 / 2;

/// Narrows or widens what stands on z = 0 linearly up to `height_m`.
void taper(Mesh& mesh, float height_m, float factor_above) {
  for (Vector3f& p : mesh.vertices) p.head<2>() *= 1.0f + (factor_above - 1.0f) * p.z() / height_m;
}

}  // namespace

ObjectModel makeMouse(RandomStream& random) {
  ObjectModel model{"mouse", {}};
  const cv::Mat3b shell = paintMottled(quietColor(random), 4, random);
  Mesh body = makeEllipsoid({size(random, 0.027, 0.034), size(random, 0.048, 0.06), 0.017f});
  model.add(std::move(body), shell, 0.2f);
  if (random.chance(0.7)) {
    std::vector<Vector3f> path;
    const float bend = size(random, -0.08, 0.08);
    for (int i = 0; i <= 8; ++i) {
      const float t = static_cast<float>(i) / 8;
      path.emplace_back(bend * t * t, -0.045f - 0.16f * t, 0.003f);
    }
    model.add(makeTube(path, std::vector<float>(path.size(), 0.002f), 6), shell, 0.1f);
  }
  return model;
}

ObjectModel makeGamepad(RandomStream& random) {
  ObjectModel model{"gamepad", {}};
  const cv::Mat3b shell = paintMottled(anyColor(random), 4, random), dark = paintMottled({50, 48, 48}, 4, random);
  model.add(makeEllipsoid({0.07f, 0.032f, 0.02f}), shell, 0.2f);
  for (const double side : {-1.0, 1.0}) {
    model.add(movedTo(makeEllipsoid({0.022f, 0.05f, 0.02f}), {side * 0.058, -0.025, 0}), shell, 0.2f);
    model.add(
        movedTo(makeLathe({{0, 0}, {0.008f, 0}, {0.007f, 0.012f}, {0, 0.012f}}, 12), {side * 0.028, -0.008, 0.036}),
        dark, 0.1f);
  }
  return model;
}

ObjectModel makeRemote(RandomStream& random) {
  ObjectModel model{"remote control", {}};
  const Vector3f body{size(random, 0.04, 0.055), size(random, 0.14, 0.2), size(random, 0.016, 0.024)};
  model.add(makeTiledBox(body, 0.3f, kObjectCell_m), paintMottled(quietColor(random), 4, random), 0.1f);
  model.add(makeRectangle({0.4f * body.x(), -0.42f * body.y(), body.z() + 5e-4f}, {-0.8f * body.x(), 0, 0},
                          {0, 0.84f * body.y(), 0}, kObjectCell_m),
            paintKeys(3, 9, random));
  return model;
}

ObjectModel makePen(RandomStream& random) {
  ObjectModel model{"pen", {}};
  const float length = size(random, 0.13, 0.18), radius = size(random, 0.004, 0.008);
  Mesh body = makeLathe({{0, 0}, {0.3f * radius, 0}, {radius, 0.014f}, {radius, length}, {0, length}}, 10);
  Pose lie = Pose::Identity();
  lie.translation().z() = static_cast<double>(radius);
  lie.rotate(Eigen::AngleAxisd(kQuarterTurn, Vector3d::UnitY()));
  body.transform(lie);
  model.add(std::move(body), paintMottled(anyColor(random), 5, random), 0.2f);
  return model;
}

ObjectModel makePenPot(RandomStream& random) {
  ObjectModel model{"pen pot", {}};
  const float radius = size(random, 0.034, 0.045), height = size(random, 0.09, 0.11);
  model.add(
      makeLathe(
          {{0, 0}, {radius, 0}, {radius, height}, {0.92f * radius, height}, {0.92f * radius, 0.006f}, {0, 0.006f}}, 24),
      paintWare(random), 0.15f);
  const int pens = 2 + random.below(5);
  for (int i = 0; i < pens; ++i) {
    const float angle = size(random, 0, 6.28), foot = 0.5f * radius, top = size(random, 0.85, 1.2) * radius;
    const float length = size(random, 0.14, 0.18);
    const Vector3f away(std::cos(angle), std::sin(angle), 0);
    model.add(
        makeTube({-foot * away + Vector3f(0, 0, 0.008f), top * away + Vector3f(0, 0, length)}, {0.004f, 0.004f}, 8),
        paintMottled(anyColor(random), 4, random), 0.15f);
  }
  return model;
}

ObjectModel makeStapler(RandomStream& random) {
  ObjectModel model{"stapler", {}};
  const cv::Mat3b shell = paintMottled(anyColor(random, 0.4), 4, random);
  model.add(makeTiledBox({0.036f, 0.13f, 0.014f}, 0.3f, kObjectCell_m), shell, 0.1f);
  Mesh arm = makeTiledBox({0.032f, 0.13f, 0.024f}, 0.3f, kObjectCell_m);
  Pose open = Pose::Identity();
  open.translate(Vector3d(0, -0.06, 0.016));
  open.rotate(Eigen::AngleAxisd(0.12, Vector3d::UnitX()));
  open.translate(Vector3d(0, 0.065, 0));
  arm.transform(open);
  model.add(std::move(arm), shell, 0.25f);
  return model;
}

ObjectModel makePaperCup(RandomStream& random) {
  ObjectModel model{"paper cup", {}};
  const float radius = size(random, 0.026, 0.033), height = size(random, 0.085, 0.12), top = size(random, 1.25, 1.4);
  std::vector<Eigen::Vector2f> profile = {{0, 0}, {radius, 0}, {top * radius, height}};
  if (random.chance(0.5)) {
    profile.insert(profile.end(),
                   {{1.06f * top * radius, height}, {1.0f * top * radius, height + 0.012f}, {0, height + 0.012f}});
  } else {
    profile.insert(profile.end(), {{0.96f * top * radius, height}, {0.96f * radius, 0.004f}, {0, 0.004f}});
  }
  model.add(makeLathe(profile, 24), paintWare(random), 0.05f);
  return model;
}

ObjectModel makeStorageBox(RandomStream& random) {
  ObjectModel model{"storage box", {}};
  const Vector3f body{size(random, 0.18, 0.36), size(random, 0.13, 0.26), size(random, 0.08, 0.17)};
  const cv::Scalar color = random.chance(0.5) ? cv::Scalar(205, 208, 205) : anyColor(random);
  Mesh box = makeTiledBox(body, 0.3f, kObjectCell_m);
  taper(box, body.z(), 1.12f);
  model.add(std::move(box), paintMottled(color, 5, random), 0.12f);
  const Vector3f lid(1.18f * body.x(), 1.18f * body.y(), 0.018f);
  model.add(movedTo(makeTiledBox(lid, 0.3f, kObjectCell_m), {0, 0, static_cast<double>(body.z())}),
            paintMottled(random.chance(0.6) ? color : anyColor(random), 5, random), 0.12f);
  if (random.chance(0.5)) {
    model.add(makeRectangle({0.06f, 0.595f * body.y(), 0.75f * body.z()}, {-0.12f, 0, 0}, {0, 0, -0.45f * body.z()},
                            kObjectCell_m),
              paintDocument(0.12, 0.05, random), 0.02f);
  }
  return model;
}

ObjectModel makeParcel(RandomStream& random) {
  ObjectModel model{"parcel", {}};
  const Vector3f body{size(random, 0.15, 0.35), size(random, 0.12, 0.26), size(random, 0.06, 0.24)};
  model.add(makeTiledBox(body, 0.5f, kObjectCell_m), paintMottled({95, 140, 175}, 7, random), 0.02f);
  model.add(
      makeRectangle({0.5f * body.x(), -0.025f, body.z() + 5e-4f}, {-body.x(), 0, 0}, {0, 0.05f, 0}, kObjectCell_m),
      paintMottled({120, 165, 195}, 3, random), 0.2f);
  model.add(makeRectangle({0.35f * body.x(), 0.5f * body.y() + 5e-4f, 0.8f * body.z()}, {-0.5f * body.x(), 0, 0},
                          {0, 0, -0.55f * body.z()}, kObjectCell_m),
            paintDocument(0.12, 0.08, random), 0.05f);
  return model;
}

ObjectModel makePlinth(RandomStream& random) {
  ObjectModel model{"plinth", {}};
  const Vector3f body{size(random, 0.2, 0.45), size(random, 0.18, 0.3), size(random, 0.02, 0.08)};
  const cv::Mat3b top =
      random.chance(0.6) ? paintMottled({222, 226, 228}, 3, random) : paintWood({110, 160, 200}, random);
  const cv::Mat3b sides = random.chance(0.5) ? paintMottled({95, 140, 175}, 7, random) : top;
  model.add(makeTiledBox(body, 0.5f, kObjectCell_m), sides, 0.03f);
  model.add(makeRectangle({0.5f * body.x(), -0.5f * body.y(), body.z() + 2e-4f}, {-body.x(), 0, 0}, {0, body.y(), 0},
                          kObjectCell_m),
            top, 0.08f);
  return model;
}

}  // namespace saccade
