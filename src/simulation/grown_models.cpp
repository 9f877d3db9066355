#include <algorithm>
#include <cmath>

#include "simulation/mesh_shapes.hpp"
#include "simulation/model_parts.hpp"
#include "simulation/object_models.hpp"
#include "simulation/texture_paint.hpp"

namespace saccade {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

Mesh makeStalk(float from_z_m, float length_m) {
  return makeTube({{0, 0, from_z_m}, {0.001f, 0, from_z_m + length_m / 2}, {0.004f, 0, from_z_m + length_m}},
                  {0.0018f, 0.0015f, 0.0015f}, 6);
}

/// A leaf of a plant: a bent strip that widens and narrows again, facing up.
void addLeaf(Mesh& mesh, const Vector3f& root, float yaw, float rise, float length_m, float width_m) {
  const Vector3f ahead(std::cos(yaw), std::sin(yaw), 0), across(-std::sin(yaw), std::cos(yaw), 0);
  constexpr std::uint32_t kSteps = 6;
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const float share = static_cast<float>(i) / kSteps;
    const Vector3f spine =
        root + length_m * (share * ahead + Vector3f(0, 0, rise * share - 0.75f * rise * share * share * share));
    const float half = width_m / 2 * std::sin(3.1416f * std::min(0.08f + 0.92f * share, 1.0f));
    for (const float side : {-1.0f, 1.0f}) {
      const std::uint32_t index =
          mesh.addVertex(spine + side * half * across + Vector3f(0, 0, 0.15f * half),
                         Vector3f(0.3f * side * across + Vector3f(0, 0, 1)).normalized(), {share, 0.5f + 0.5f * side});
      if (i == 0 && side < 0) first = index;
    }
    if (i == 0) continue;
    const std::uint32_t a = first + 2 * (i - 1);
    mesh.triangles.push_back({a, a + 2, a + 3});
    mesh.triangles.push_back({a, a + 3, a + 1});
  }
}

cv::Mat3b paintLeaf(RandomStream& random) {
  const double blue = random.between(30, 70), green = random.between(95, 150), red = random.between(35, 90);
  cv::Mat3b image = paintMottled({blue, green, red}, 14, random);
  image.rowRange(60, 67) += cv::Scalar(30, 45, 35);
  return image;
}

}  // namespace

ObjectModel makeApple(RandomStream& random) {
  const float radius = size(random, 0.034, 0.042);
  ObjectModel model{"apple", {}};
  std::vector<Vector2f> profile;
  for (int i = 0; i <= 14; ++i) {
    const float angle = 3.14159265f * static_cast<float>(i) / 14;
    const float dimple = 0.16f * std::pow(std::abs(std::cos(angle)), 8.0f);
    profile.emplace_back(radius * std::sin(angle) * (1 + 0.06f * std::cos(angle) * -1),
                         radius * (0.92f - (0.92f - dimple) * std::cos(angle)));
  }
  profile.front().x() = profile.back().x() = 0.0f;
  // It stands on the rim around its lower dimple.
  const auto lowest = [](const Vector2f& p, const Vector2f& q) { return p.y() < q.y(); };
  const float rim = std::min_element(profile.begin(), profile.end(), lowest)->y();
  for (Vector2f& p : profile) p.y() -= rim;
  static const cv::Scalar kSkins[] = {{40, 40, 175}, {60, 160, 130}, {70, 170, 215}, {45, 60, 200}};
  model.add(makeLathe(profile), paintMottled(kSkins[random.below(4)], 26, random), 0.15f);
  model.add(makeStalk(1.5f * radius, 0.02f), paintMottled({40, 65, 95}, 5, random));
  return model;
}

ObjectModel makeCitrus(RandomStream& random) {
  const bool lemon = random.chance(0.4);
  const float radius = lemon ? size(random, 0.027, 0.031) : size(random, 0.034, 0.043);
  ObjectModel model{lemon ? "lemon" : "orange", {}};
  model.add(makeEllipsoid({lemon ? 1.35f * radius : radius, radius, radius}),
            paintMottled(lemon ? cv::Scalar(60, 205, 230) : cv::Scalar(25, 130, 235), 14, random), 0.1f);
  return model;
}

ObjectModel makePear(RandomStream& random) {
  const float radius = size(random, 0.032, 0.038);
  ObjectModel model{"pear", {}};
  std::vector<Vector2f> profile;
  for (int i = 0; i <= 12; ++i) {
    const float share = static_cast<float>(i) / 12;
    profile.emplace_back(
        radius * (std::sin(3.1416f * std::pow(share, 0.72f)) * (1 - 0.38f * share) + 0.1f * share * (1 - share)),
        2.7f * radius * share);
  }
  profile.front().x() = profile.back().x() = 0.0f;
  model.add(makeLathe(profile), paintMottled({60, 165, 170}, 22, random), 0.1f);
  model.add(makeStalk(2.62f * radius, 0.018f), paintMottled({40, 65, 95}, 5, random));
  return model;
}

ObjectModel makeBanana(RandomStream& random) {
  ObjectModel model{"banana", {}};
  const float bend = size(random, 0.09, 0.12), thick = size(random, 0.016, 0.019);
  std::vector<Vector3f> path;
  std::vector<float> radii;
  for (int i = 0; i <= 14; ++i) {
    const float share = static_cast<float>(i) / 14, angle = 0.5f + 1.7f * share;
    path.emplace_back(bend * std::cos(angle), bend * (std::sin(angle) - 0.8f), thick);
    radii.push_back(thick * std::min({1.0f, 0.35f + 4.0f * share, 0.3f + 5.0f * (1 - share)}));
  }
  model.add(makeTube(path, radii, 12), paintMottled({45, 195, 225}, 20, random), 0.08f);
  return model;
}

ObjectModel makePlant(RandomStream& random) {
  ObjectModel model{"plant", {}};
  const float radius = size(random, 0.045, 0.07), height = size(random, 0.08, 0.12);
  const cv::Scalar clay = random.chance(0.5) ? cv::Scalar(70, 105, 175) : anyColor(random);
  model.add(makeLathe({{0, 0},
                       {0.75f * radius, 0},
                       {0.96f * radius, 0.8f * height},
                       {radius, 0.8f * height},
                       {radius, height},
                       {0.92f * radius, height},
                       {0.9f * radius, 0.88f * height},
                       {0, 0.88f * height}}),
            paintMottled(clay, 10, random));
  Mesh leaves;
  const int count = 16 + random.below(14);
  for (int i = 0; i < count; ++i) {
    const float yaw = size(random, 0, 6.28), rise = size(random, 0.4, 1.7), length = size(random, 0.07, 0.14);
    const float width = size(random, 0.025, 0.05);
    const Vector3f root(0.25f * radius * std::cos(yaw), 0.25f * radius * std::sin(yaw),
                        0.88f * height + size(random, 0, 0.05));
    addLeaf(leaves, root, yaw, rise, length, width);
  }
  model.add(std::move(leaves), paintLeaf(random), 0.1f);
  model.add(makeTube({{0, 0, 0.85f * height}, {0.004f, 0, height + 0.05f}}, {0.006f, 0.003f}, 6), paintLeaf(random));
  return model;
}

}  // namespace saccade
