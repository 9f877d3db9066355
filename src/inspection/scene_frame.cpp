#include "saccade/inspection/scene_frame.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "inspection/leaf_walk.hpp"

namespace saccade {
namespace {

constexpr double kWidestTilt_rad = 60.0 * M_PI / 180.0;  ///< of up from the first camera's own
constexpr double kSameSurface_rad = 10.0 * M_PI / 180.0;
constexpr double kStrayShare = 0.002;  ///< of the leaves at either end of an axis that the extent leaves out
constexpr int kSteps = 8;              ///< of the climb to the densest direction

struct FacingArea {
  Eigen::Vector3f normal;
  float area;
};

/// The direction around `start` in which most area faces, by repeated means over a shrinking cone (mean shift).
Eigen::Vector3d densestDirection(const std::vector<FacingArea>& faces, const Eigen::Vector3d& start) {
  Eigen::Vector3f direction = start.cast<float>();
  for (int step = 0; step < kSteps; ++step) {
    const double share = static_cast<double>(step) / (kSteps - 1);
    const auto least_cosine =
        static_cast<float>(std::cos(kWidestTilt_rad + share * (kSameSurface_rad - kWidestTilt_rad)));
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const FacingArea& face : faces) {
      if (face.normal.dot(direction) >= least_cosine) sum += face.area * face.normal;
    }
    if (sum.norm() == 0.0f) break;
    direction = sum.normalized();
  }
  return direction.cast<double>();
}

/// The part of one axis that holds all but the outermost leaves at either end, as keys; `counts` by key.
std::pair<int, int> extentOf(const std::vector<std::int64_t>& counts, std::int64_t total) {
  const auto stray = static_cast<std::int64_t>(kStrayShare * static_cast<double>(total));
  int low = 0, high = static_cast<int>(counts.size()) - 1;
  for (std::int64_t passed = 0; (passed += counts[static_cast<std::size_t>(low)]) <= stray;) ++low;
  for (std::int64_t passed = 0; (passed += counts[static_cast<std::size_t>(high)]) <= stray;) --high;
  return {low, high + 1};
}

}  // namespace

SceneFrame findSceneFrame(const MapTree& map) {
  SceneFrame scene;
  std::vector<FacingArea> faces;
  const auto least_cosine = static_cast<float>(std::cos(kWidestTilt_rad));
  std::array<std::vector<std::int64_t>, 3> counts;
  for (auto& axis : counts) axis.assign(2 * MapTree::kCentreKey, 0);
  std::int64_t total = 0;
  forEachOccupiedLeaf(map, [&](const NodeKey& key, MapNode leaf) {
    const int edge = 1 << (MapTree::kDepth - key.depth);
    const std::array<int, 3> corner = {key.corner.x, key.corner.y, key.corner.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < edge; ++i) counts[axis][static_cast<std::size_t>(corner[axis] + i)] += edge * edge;
    }
    total += std::int64_t{edge} * edge * edge;
    const Eigen::Vector3f normal = leaf.surface().normal();
    if (-normal.y() >= least_cosine) faces.push_back({normal, static_cast<float>(edge * edge)});
  });
  if (!faces.empty()) scene.up_W = densestDirection(faces, scene.up_W);
  if (total == 0) return scene;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = extentOf(counts[axis], total);
    scene.box.min()[static_cast<Eigen::Index>(axis)] = (low - MapTree::kCentreKey) * map.leaf_size_m;
    scene.box.max()[static_cast<Eigen::Index>(axis)] = (high - MapTree::kCentreKey) * map.leaf_size_m;
  }
  return scene;
}

}  // namespace saccade
