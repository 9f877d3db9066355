#include <cmath>

#include "simulation/mesh_shapes.hpp"
#include "simulation/model_parts.hpp"
#include "simulation/object_models.hpp"
#include "simulation/print_paint.hpp"
#include "simulation/texture_paint.hpp"

namespace saccade {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kQuarterTurn = 3.14159265358979 / 2;

/// Turns a mesh that stands along z so that it lies along x, its axis at `height_m`.
Mesh lying(Mesh mesh, float height_m, const Vector3d& shift = Vector3d::Zero()) {
  Pose lie = Pose::Identity();
  lie.translation() = shift + Vector3d(0, 0, static_cast<double>(height_m));
  lie.rotate(Eigen::AngleAxisd(kQuarterTurn, Vector3d::UnitY()));
  mesh.transform(lie);
  return mesh;
}

}  // namespace

ObjectModel makeHammer(RandomStream& random) {
  ObjectModel model{"hammer", {}};
  const float length = size(random, 0.22, 0.28), radius = 0.014f;
  const cv::Mat3b steel = paintMottled({120, 122, 125}, 12, random);
  model.add(lying(makeLathe({{0, 0},
                             {radius, 0},
                             {radius, 0.4f * length},
                             {0.7f * radius, 0.6f * length},
                             {0.7f * radius, length},
                             {0, length}}),
                  radius),
            random.chance(0.5) ? paintWood({110, 160, 200}, random) : paintMottled(vividColor(random), 8, random));
  model.add(movedTo(makeTiledBox({0.028f, 0.1f, 0.028f}, 0.2f, kObjectCell_m),
                    {static_cast<double>(length) - 0.012, 0.005, 0}),
            steel, 0.4f);
  return model;
}

ObjectModel makeScrewdriver(RandomStream& random) {
  ObjectModel model{"screwdriver", {}};
  const float radius = size(random, 0.012, 0.016), shaft = size(random, 0.08, 0.14);
  model.add(lying(makeLathe({{0, 0},
                             {0.8f * radius, 0},
                             {radius, 0.01f},
                             {radius, 0.07f},
                             {0.7f * radius, 0.085f},
                             {0.8f * radius, 0.1f},
                             {0, 0.1f}},
                            12),
                  radius),
            paintWare(random), 0.2f);
  model.add(lying(makeLathe({{0, 0.1f}, {0.004f, 0.1f}, {0.004f, 0.1f + shaft}, {0, 0.1f + shaft}}, 10), radius),
            paintMottled({140, 142, 145}, 6, random), 0.5f);
  return model;
}

ObjectModel makeTapeRoll(RandomStream& random) {
  ObjectModel model{"tape", {}};
  const float outer = size(random, 0.04, 0.055), inner = size(random, 0.55, 0.7) * outer,
              height = size(random, 0.018, 0.05);
  const cv::Scalar color = random.chance(0.5) ? cv::Scalar(90, 150, 190) : vividColor(random);
  model.add(makeLathe({{inner, 0}, {outer, 0}, {outer, height}, {inner, height}, {inner, 0}}),
            paintMottled(color, 8, random), 0.15f);
  return model;
}

ObjectModel makeToyCar(RandomStream& random) {
  ObjectModel model{"toy car", {}};
  const float length = size(random, 0.11, 0.17), height = 0.5f * length, width = 0.5f * length;
  const float wheel = 0.11f * length;
  Mesh body = makeExtrusion({{-0.5f * length, wheel},
                             {0.5f * length, wheel},
                             {0.5f * length, 0.5f * height},
                             {0.3f * length, 0.58f * height},
                             {0.16f * length, height},
                             {-0.3f * length, height},
                             {-0.42f * length, 0.6f * height},
                             {-0.5f * length, 0.55f * height}},
                            width);
  Pose upright = Pose::Identity();
  upright.translation().y() = static_cast<double>(width) / 2;
  upright.rotate(Eigen::AngleAxisd(kQuarterTurn, Vector3d::UnitX()));
  body.transform(upright);
  cv::Mat3b paint = paintPackage(0.15, 0.08, random);
  model.add(std::move(body), paint, 0.3f);
  const cv::Mat3b rubber = paintMottled({45, 45, 48}, 8, random);
  for (const double x : {-0.3, 0.3}) {
    for (const double y : {-0.5, 0.5}) {
      Mesh disc = makeLathe({{0, 0}, {wheel, 0}, {wheel, 0.02f}, {0, 0.02f}}, 16);
      Pose stand = Pose::Identity();
      stand.translation() =
          Vector3d(x * static_cast<double>(length), y * static_cast<double>(width) + 0.01, static_cast<double>(wheel));
      stand.rotate(Eigen::AngleAxisd(kQuarterTurn, Vector3d::UnitX()));
      disc.transform(stand);
      model.add(std::move(disc), rubber);
    }
  }
  return model;
}

ObjectModel makeToyBear(RandomStream& random) {
  ObjectModel model{"teddy bear", {}};
  const double s = random.between(0.75, 1.15);
  const cv::Scalar fur = random.chance(0.6) ? cv::Scalar(70, 110, 160) : anyColor(random);
  const cv::Mat3b plush = paintMottled(fur, 34, random), light = paintMottled({150, 185, 215}, 20, random),
                  black = paintMottled({40, 38, 38}, 4, random);
  const auto ball = [&](const Vector3d& half, const Vector3d& foot, const cv::Mat3b& texture) {
    model.add(movedTo(makeEllipsoid((s * half).cast<float>()), s * foot), texture);
  };
  ball({0.052, 0.045, 0.062}, {0, 0, 0}, plush);
  ball({0.043, 0.04, 0.04}, {0, 0.005, 0.105}, plush);
  ball({0.02, 0.018, 0.016}, {0, 0.04, 0.115}, light);
  ball({0.006, 0.005, 0.005}, {0, 0.056, 0.132}, black);
  for (const double side : {-1.0, 1.0}) {
    ball({0.016, 0.009, 0.016}, {side * 0.034, 0, 0.163}, plush);
    ball({0.005, 0.004, 0.005}, {side * 0.016, 0.040, 0.148}, black);
    ball({0.018, 0.018, 0.038}, {side * 0.055, 0.015, 0.04}, plush);
    ball({0.022, 0.042, 0.02}, {side * 0.034, 0.05, 0}, plush);
  }
  return model;
}

ObjectModel makeDuck(RandomStream& random) {
  ObjectModel model{"duck", {}};
  const cv::Mat3b yellow = paintMottled({40, 200, 235}, 6, random), beak = paintMottled({30, 110, 230}, 4, random),
                  black = paintMottled({35, 35, 35}, 3, random);
  model.add(makeEllipsoid({0.045f, 0.036f, 0.03f}), yellow, 0.25f);
  model.add(movedTo(makeEllipsoid({0.026f, 0.025f, 0.026f}), {0.022, 0, 0.045}), yellow, 0.25f);
  model.add(movedTo(makeEllipsoid({0.014f, 0.012f, 0.005f}), {0.05, 0, 0.065}), beak, 0.2f);
  model.add(movedTo(makeEllipsoid({0.015f, 0.012f, 0.018f}), {-0.042, 0, 0.03}), yellow, 0.25f);
  for (const double side : {-0.013, 0.013}) {
    model.add(movedTo(makeEllipsoid({0.004f, 0.004f, 0.004f}), {0.042, side, 0.075}), black);
  }
  return model;
}

ObjectModel makeBricks(RandomStream& random) {
  ObjectModel model{"toy bricks", {}};
  constexpr float kStud = 0.016f, kHeight = 0.019f;
  const int layers = 2 + random.below(4);
  for (int layer = 0; layer < layers; ++layer) {
    const int columns = 4 - layer / 2, rows = 2;
    const cv::Mat3b plastic = paintMottled(vividColor(random), 3, random);
    const double shift = 0.5 * static_cast<double>(kStud) * (layer % 2);
    const double z = static_cast<double>(kHeight) * layer;
    Mesh brick = movedTo(makeBox({static_cast<float>(columns) * kStud, static_cast<float>(rows) * kStud, kHeight}),
                         {shift, 0, z});
    if (layer + 1 == layers) {
      for (int column = 0; column < columns; ++column) {
        for (int row = 0; row < rows; ++row) {
          brick.append(movedTo(makeLathe({{0.005f, kHeight}, {0.005f, kHeight + 0.004f}, {0, kHeight + 0.004f}}, 10),
                               {shift + static_cast<double>(kStud) * (column - 0.5 * (columns - 1)),
                                static_cast<double>(kStud) * (row - 0.5 * (rows - 1)), z}));
        }
      }
    }
    model.add(std::move(brick), plastic, 0.25f);
  }
  return model;
}

ObjectModel makeBall(RandomStream& random) {
  ObjectModel model{"ball", {}};
  const float radius = size(random, 0.03, 0.07);
  cv::Mat3b skin = random.chance(0.5) ? paintCloth(random) : paintWare(random);
  Mesh ball = makeEllipsoid({radius, radius, radius});
  const double tilt = random.between(0, 3);
  Pose turn = Pose::Identity();
  turn.translate(Vector3d(0, 0, static_cast<double>(radius)));
  turn.rotate(Eigen::AngleAxisd(tilt, Vector3d::UnitX()));
  turn.translate(Vector3d(0, 0, -static_cast<double>(radius)));
  ball.transform(turn);
  model.add(std::move(ball), skin, 0.1f);
  return model;
}

ObjectModel makeTelephone(RandomStream& random) {
  ObjectModel model{"telephone", {}};
  const cv::Mat3b shell = paintMottled(anyColor(random, 0.3), 4, random);
  model.add(makeTiledBox({0.16f, 0.19f, 0.03f}, 0.3f, kObjectCell_m), shell, 0.15f);
  model.add(makeRectangle({0.075f, 0.03f, 0.0305f}, {-0.095f, 0, 0}, {0, 0.06f, 0}, kObjectCell_m),
            paintKeys(4, 4, random));
  Mesh receiver = movedTo(makeTiledBox({0.045f, 0.19f, 0.03f}, 0.3f, kObjectCell_m), {-0.052, 0, 0.03});
  for (const double y : {-0.07, 0.07}) {
    receiver.append(movedTo(makeEllipsoid({0.03f, 0.028f, 0.02f}), {-0.052, y, 0.031}));
  }
  model.add(std::move(receiver), shell, 0.15f);
  return model;
}

ObjectModel makeLaptop(RandomStream& random) {
  ObjectModel model{"laptop", {}};
  const cv::Mat3b shell =
      paintMottled(random.chance(0.5) ? cv::Scalar(165, 165, 162) : cv::Scalar(62, 60, 60), 4, random);
  model.add(makeTiledBox({0.33f, 0.23f, 0.018f}, 0.3f, kObjectCell_m), shell, 0.15f);
  model.add(makeRectangle({0.15f, -0.08f, 0.0185f}, {-0.30f, 0, 0}, {0, 0.11f, 0}, kObjectCell_m),
            paintKeys(15, 6, random));
  Pose open = Pose::Identity();
  open.translate(Vector3d(0, -0.112, 0.016));
  open.rotate(Eigen::AngleAxisd(random.between(0.2, 0.5), Vector3d::UnitX()));
  Mesh lid = makeTiledBox({0.33f, 0.008f, 0.22f}, 0.3f, kObjectCell_m);
  Mesh screen = makeRectangle({0.155f, 0.0045f, 0.212f}, {-0.31f, 0, 0}, {0, 0, -0.2f}, kObjectCell_m);
  lid.transform(open);
  screen.transform(open);
  model.add(std::move(lid), shell, 0.15f);
  model.add(std::move(screen), paintPoster(0.5, 0.33, random), 0.3f);
  return model;
}

ObjectModel makeKeyboard(RandomStream& random) {
  ObjectModel model{"keyboard", {}};
  model.add(makeTiledBox({0.42f, 0.14f, 0.02f}, 0.3f, kObjectCell_m), paintMottled({60, 58, 58}, 4, random), 0.1f);
  model.add(makeRectangle({0.205f, -0.06f, 0.0205f}, {-0.41f, 0, 0}, {0, 0.12f, 0}, kObjectCell_m),
            paintKeys(20, 6, random));
  return model;
}

ObjectModel makeClock(RandomStream& random) {
  ObjectModel model{"clock", {}};
  const float radius = size(random, 0.045, 0.07);
  const auto standing = [&](Mesh disc, double y) {
    Pose stand = Pose::Identity();
    stand.translation() = Vector3d(0, y, static_cast<double>(radius));
    stand.rotate(Eigen::AngleAxisd(-kQuarterTurn, Vector3d::UnitX()));
    disc.transform(stand);
    return disc;
  };
  model.add(standing(makeLathe({{0, 0}, {radius, 0}, {radius, 0.04f}, {0.88f * radius, 0.04f}}), -0.02),
            paintMottled(anyColor(random), 5, random), 0.25f);
  cv::Mat3b face(16, 96, cv::Vec3b(228, 232, 234));
  for (int hour = 0; hour < 12; ++hour) face(cv::Rect(8 * hour, 9, 2, 6)).setTo(cv::Scalar(30, 30, 30));
  face(cv::Rect(10 + random.below(60), 1, 3, 11)).setTo(cv::Scalar(30, 30, 160));
  model.add(standing(makeLathe({{0.9f * radius, 0.036f}, {0, 0.036f}}), -0.02), face, 0.2f);
  // A foot on either side keeps it from rolling.
  Mesh feet = movedTo(makeBox({0.5f * radius, 0.05f, 0.008f}), {0, 0, 0});
  model.add(std::move(feet), paintMottled({50, 50, 52}, 4, random));
  return model;
}

ObjectModel makeBasket(RandomStream& random) {
  ObjectModel model{"basket", {}};
  const float radius = size(random, 0.12, 0.17), height = size(random, 0.2, 0.32);
  model.add(makeLathe({{0, 0},
                       {0.8f * radius, 0},
                       {radius, height},
                       {radius - 0.01f, height},
                       {0.8f * radius - 0.01f, 0.01f},
                       {0, 0.01f}}),
            paintCloth(random));
  return model;
}

}  // namespace saccade
