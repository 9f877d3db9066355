#include "saccade/inspection/up_direction.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "inspection/leaf_walk.hpp"

namespace saccade {
namespace {

constexpr double kWidestTilt_rad = 45.0 * M_PI / 180.0;  ///< of up from the cameras' own
constexpr double kSameSurface_rad = 12.0 * M_PI / 180.0;
constexpr float kBinsAUnit = 6.0f;  ///< of the coarse histogram of directions: some 10 degrees wide
constexpr int kRounds = 10;         ///< of the mean shift

struct FacingArea {
  Eigen::Vector3f normal;
  float area;  ///< finest leaves
};

Eigen::Vector3d meanCameraUp(std::span<const FrameRecord> frames) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const FrameRecord& frame : frames) {
    if (frame.T_WC) sum -= frame.T_WC->linear().col(1);  // the image's y axis points down
  }
  return sum.norm() > 1e-6 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
}

std::vector<FacingArea> facesNear(const MapTree& map, const Eigen::Vector3d& direction) {
  std::vector<FacingArea> faces;
  const Eigen::Vector3f wanted = direction.cast<float>();
  // The mean shift may lean out of the cone in which it starts.
  const auto least = static_cast<float>(std::cos(kWidestTilt_rad + 2.0 * kSameSurface_rad));
  forEachOccupiedLeaf(map, [&](const NodeKey& key, MapNode leaf) {
    const Eigen::Vector3f normal = leaf.surface().normal();
    const auto edge = static_cast<float>(1 << (MapTree::kDepth - key.depth));
    if (normal.dot(wanted) >= least) faces.push_back({normal, edge * edge});
  });
  return faces;
}

/// The fullest bin of a coarse histogram of directions within the cone around `prior`, as a start.
Eigen::Vector3d commonestDirection(const std::vector<FacingArea>& faces, const Eigen::Vector3d& prior) {
  std::map<std::tuple<int, int, int>, float> areas;
  const auto least = static_cast<float>(std::cos(kWidestTilt_rad));
  const Eigen::Vector3f wanted = prior.cast<float>();
  for (const FacingArea& face : faces) {
    if (face.normal.dot(wanted) < least) continue;
    const auto bin = [&](int i) { return static_cast<int>(std::lround(face.normal[i] * kBinsAUnit)); };
    areas[{bin(0), bin(1), bin(2)}] += face.area;
  }
  if (areas.empty()) return prior;
  const auto fullest =
      std::max_element(areas.begin(), areas.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto& [x, y, z] = fullest->first;
  return Eigen::Vector3d(x, y, z).normalized();
}

}  // namespace

Eigen::Vector3d estimateUp(const MapTree& map, std::span<const FrameRecord> frames) {
  const Eigen::Vector3d prior = meanCameraUp(frames);
  const std::vector<FacingArea> faces = facesNear(map, prior);
  Eigen::Vector3d up = commonestDirection(faces, prior);
  const auto near = static_cast<float>(std::cos(kSameSurface_rad));
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::Vector3f centre = up.cast<float>();
    for (const FacingArea& face : faces) {
      if (face.normal.dot(centre) >= near) sum += (face.area * face.normal).cast<double>();
    }
    if (sum.norm() < 1e-6) break;
    up = sum.normalized();
  }
  return up;
}

}  // namespace saccade
