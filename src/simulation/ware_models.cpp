#include <cmath>

#include "simulation/mesh_shapes.hpp"
#include "simulation/model_parts.hpp"
#include "simulation/object_models.hpp"
#include "simulation/print_paint.hpp"
#include "simulation/texture_paint.hpp"

namespace saccade {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kWall_m = 0.004f;

/// Half a ring in the plane y = 0 from (x, high) out to x + reach and back to (x, low).
Mesh makeHandle(float x_m, float low_m, float high_m, float reach_m, float radius_m) {
  std::vector<Vector3f> path;
  std::vector<float> radii;
  constexpr int kSteps = 12;
  const float middle = (low_m + high_m) / 2, half = (high_m - low_m) / 2;
  for (int i = 0; i <= kSteps; ++i) {
    const float angle = 3.14159265f * (static_cast<float>(i) / kSteps - 0.5f);
    path.emplace_back(x_m + reach_m * std::cos(angle), 0.0f, middle + half * std::sin(angle));
    radii.push_back(radius_m);
  }
  return makeTube(path, radii);
}

/// A vessel with a wall: outside up, over the rim, inside down.
Mesh makeVessel(std::vector<Vector2f> outside) {
  const std::size_t count = outside.size();
  for (std::size_t i = count; i-- > 0;) {
    const Vector2f& p = outside[i];
    if (p.x() <= kWall_m) break;
    outside.emplace_back(p.x() - kWall_m, i + 1 == count ? p.y() : std::max(p.y(), kWall_m));
  }
  outside.emplace_back(0.0f, outside.back().y());
  return makeLathe(outside);
}

}  // namespace

ObjectModel makeMug(RandomStream& random) {
  const float radius = size(random, 0.036, 0.046), height = size(random, 0.08, 0.11);
  const float flare = size(random, -0.006, 0.006);
  ObjectModel model{"mug", {}};
  const cv::Mat3b glaze = paintWare(random);
  model.add(makeVessel({{0, 0}, {radius + flare - 0.003f, 0}, {radius + flare, 0.004f}, {radius, height}}), glaze,
            0.35f);
  model.add(makeHandle(radius - 0.003f, 0.22f * height, 0.8f * height, 0.03f, 0.006f), glaze, 0.35f);
  return model;
}

ObjectModel makeBowl(RandomStream& random) {
  const float radius = size(random, 0.065, 0.11), height = size(random, 0.05, 0.08);
  ObjectModel model{"bowl", {}};
  std::vector<Vector2f> outside = {{0, 0}, {0.45f * radius, 0}, {0.45f * radius, 0.008f}};
  for (int i = 1; i <= 6; ++i) {
    const float share = static_cast<float>(i) / 6;
    outside.emplace_back(radius * (0.45f + 0.55f * std::sin(1.57f * share)),
                         0.008f + (height - 0.008f) * (1 - std::cos(1.57f * share)));
  }
  model.add(makeVessel(outside), paintWare(random), 0.35f);
  return model;
}

ObjectModel makePlate(RandomStream& random) {
  const float radius = size(random, 0.09, 0.125);
  ObjectModel model{"plate", {}};
  const cv::Mat3b glaze = paintWare(random);
  model.add(makeVessel({{0, 0}, {0.6f * radius, 0}, {0.66f * radius, 0.006f}, {radius, 0.022f}}), glaze, 0.35f);
  return model;
}

ObjectModel makeBottle(RandomStream& random) {
  const float radius = size(random, 0.028, 0.042), height = size(random, 0.19, 0.31);
  const float neck = size(random, 0.011, 0.015), shoulder = size(random, 0.55, 0.72) * height;
  ObjectModel model{"bottle", {}};
  std::vector<Vector2f> profile = {{0, 0}, {radius - 0.004f, 0}, {radius, 0.005f}, {radius, shoulder}};
  for (int i = 1; i <= 5; ++i) {
    const float share = static_cast<float>(i) / 5;
    profile.emplace_back(neck + (radius - neck) * 0.5f * (1 + std::cos(3.1416f * share)),
                         shoulder + 0.17f * height * share);
  }
  profile.insert(profile.end(),
                 {{neck, height - 0.02f}, {neck + 0.003f, height - 0.02f}, {neck + 0.003f, height}, {0, height}});
  const cv::Scalar glass = random.chance(0.5) ? vividColor(random) * 0.55 : anyColor(random);
  model.add(makeLathe(profile), paintWrap(glass, 0.42, 0.78, 0.13, random), 0.4f);
  return model;
}

ObjectModel makeSprayBottle(RandomStream& random) {
  const float radius = size(random, 0.034, 0.042), height = size(random, 0.15, 0.19);
  ObjectModel model{"spray bottle", {}};
  model.add(makeLathe({{0, 0},
                       {radius, 0},
                       {radius, 0.7f * height},
                       {0.5f * radius, 0.88f * height},
                       {0.014f, height},
                       {0.014f, height + 0.015f},
                       {0, height + 0.015f}}),
            paintWrap(anyColor(random, 0.8), 0.4, 0.82, 0, random), 0.2f);
  const cv::Mat3b plastic = paintMottled(anyColor(random, 0.8), 4, random);
  Mesh head = makeBox({0.085f, 0.026f, 0.03f}), trigger = makeBox({0.01f, 0.014f, 0.045f});
  head.transform(Pose(Eigen::Translation3d(0.018, 0, static_cast<double>(height) + 0.012)));
  trigger.transform(Pose(Eigen::Translation3d(0.035, 0, static_cast<double>(height) - 0.03)));
  model.add(std::move(head), plastic, 0.2f);
  model.add(std::move(trigger), plastic, 0.2f);
  return model;
}

ObjectModel makeCan(RandomStream& random) {
  const bool drink = random.chance(0.5);
  const float radius = drink ? 0.033f : size(random, 0.035, 0.05), height = drink ? 0.12f : size(random, 0.07, 0.12);
  const float neck = drink ? 0.006f : 0.001f;
  ObjectModel model{"can", {}};
  model.add(makeLathe({{0, 0},
                       {radius - neck, 0},
                       {radius, 1.5f * neck},
                       {radius, height - 1.5f * neck},
                       {radius - neck, height},
                       {radius - neck - 0.002f, height},
                       {radius - neck - 0.003f, height - 0.003f},
                       {0, height - 0.003f}}),
            paintWrap({190, 192, 194}, 0.22, 0.8, 0, random), 0.5f);
  return model;
}

ObjectModel makeJar(RandomStream& random) {
  const float radius = size(random, 0.03, 0.048), height = size(random, 0.08, 0.15);
  ObjectModel model{"jar", {}};
  model.add(makeLathe({{0, 0},
                       {radius, 0},
                       {radius, 0.78f * height},
                       {0.85f * radius, 0.86f * height},
                       {0.9f * radius, 0.86f * height},
                       {0.9f * radius, height},
                       {0, height}}),
            paintWrap(vividColor(random) * 0.7, 0.42, 0.78, 0.33, random), 0.3f);
  return model;
}

ObjectModel makeTeapot(RandomStream& random) {
  const float radius = size(random, 0.07, 0.09);
  ObjectModel model{"teapot", {}};
  const cv::Mat3b glaze = paintWare(random);
  std::vector<Vector2f> profile = {{0, 0}, {0.6f * radius, 0}};
  for (int i = 1; i <= 8; ++i) {
    const float angle = -0.9f + 2.0f * static_cast<float>(i) / 8;
    profile.emplace_back(radius * std::cos(angle), radius * (0.78f + 0.85f * std::sin(angle)));
  }
  const float top = profile.back().y();
  profile.insert(profile.end(),
                 {{0.3f * radius, top + 0.012f}, {0.012f, top + 0.018f}, {0.016f, top + 0.032f}, {0, top + 0.036f}});
  model.add(makeLathe(profile), glaze, 0.4f);
  model.add(makeHandle(-0.9f * radius, 0.4f * radius, 1.25f * radius, -0.5f * radius, 0.008f), glaze, 0.4f);
  model.add(makeTube({{0.8f * radius, 0, 0.5f * radius},
                      {1.25f * radius, 0, 0.8f * radius},
                      {1.45f * radius, 0, 1.2f * radius},
                      {1.65f * radius, 0, 1.4f * radius}},
                     {0.022f, 0.016f, 0.011f, 0.009f}),
            glaze, 0.4f);
  return model;
}

ObjectModel makeVase(RandomStream& random) {
  const float radius = size(random, 0.04, 0.065), height = size(random, 0.15, 0.25);
  ObjectModel model{"vase", {}};
  const float phase = size(random, 0.0, 2.0);
  std::vector<Vector2f> outside = {{0, 0}};
  for (int i = 0; i <= 10; ++i) {
    const float share = static_cast<float>(i) / 10;
    outside.emplace_back(radius * (0.72f + 0.28f * std::sin(phase + 4.2f * share)), height * share);
  }
  model.add(makeVessel(outside), paintWare(random), 0.35f);
  return model;
}

ObjectModel makeCoffeeMachine(RandomStream& random) {
  ObjectModel model{"coffee machine", {}};
  const cv::Mat3b body =
      paintMottled(random.chance(0.5) ? cv::Scalar(70, 68, 66) : vividColor(random) * 0.8, 5, random);
  const cv::Mat3b steel = paintMottled({165, 168, 170}, 6, random);
  const auto addAt = [&](const Vector3f& size_m, const Eigen::Vector3d& foot, const cv::Mat3b& texture, float gloss) {
    Mesh mesh = makeTiledBox(size_m, 0.3f, kObjectCell_m);
    mesh.transform(Pose(Eigen::Translation3d(foot)));
    model.add(std::move(mesh), texture, gloss);
  };
  addAt({0.22f, 0.30f, 0.05f}, {0, 0, 0}, steel, 0.5f);
  addAt({0.22f, 0.15f, 0.21f}, {0, -0.075, 0.05}, body, 0.2f);
  addAt({0.22f, 0.30f, 0.10f}, {0, 0, 0.26}, body, 0.2f);
  addAt({0.05f, 0.05f, 0.03f}, {0, 0.075, 0.23}, steel, 0.5f);
  Mesh panel = makeRectangle({0.10f, 0.1502f, 0.355f}, {-0.20f, 0, 0}, {0, 0, -0.09f}, kObjectCell_m);
  model.add(std::move(panel), paintKeys(7, 3, random), 0.1f);
  return model;
}

ObjectModel makeToaster(RandomStream& random) {
  ObjectModel model{"toaster", {}};
  const cv::Mat3b shell = paintMottled(anyColor(random), 5, random);
  std::vector<Vector2f> outline;
  for (const float corner : {1.0f, -1.0f}) {
    for (int i = 0; i <= 5; ++i) {
      const float angle = 1.5708f * static_cast<float>(i) / 5 + (corner > 0 ? 0.0f : 1.5708f);
      outline.emplace_back(corner * 0.055f + 0.03f * std::cos(angle), 0.15f + 0.03f * std::sin(angle));
    }
  }
  outline.emplace_back(-0.085f, 0.0f);
  outline.emplace_back(0.085f, 0.0f);
  Mesh body = makeExtrusion(outline, 0.28f);
  Pose lie = Pose::Identity();
  lie.translation() = Eigen::Vector3d(0, 0.14, 0);
  lie.rotate(Eigen::AngleAxisd(3.14159265 / 2, Eigen::Vector3d::UnitX()));
  body.transform(lie);
  Pose turn = Pose::Identity();
  turn.rotate(Eigen::AngleAxisd(3.14159265 / 2, Eigen::Vector3d::UnitZ()));
  body.transform(turn);
  model.add(std::move(body), shell, 0.35f);
  const cv::Mat3b dark = paintMottled({40, 40, 42}, 4, random);
  for (const double y : {-0.022, 0.022}) {
    Mesh slot = makeTiledBox({0.2f, 0.016f, 0.003f}, 0.3f, kObjectCell_m);
    slot.transform(Pose(Eigen::Translation3d(0, y, 0.1795)));
    model.add(std::move(slot), dark);
  }
  return model;
}

}  // namespace saccade
