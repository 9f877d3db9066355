#include "saccade/exchange/up_direction.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace saccade {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

Eigen::Vector3d meanCameraUp(std::span<const FrameRecord> frames) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const FrameRecord& frame : frames) {
    if (frame.T_WC) sum -= frame.T_WC->linear().col(1);  // the image's y axis points down
  }
  return sum.norm() > 1e-6 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
}

/// The fullest bin of a coarse histogram of directions, as a start.
Eigen::Vector3d commonestDirection(std::span<const MapPoint> points, const Eigen::Vector3d& prior) {
  constexpr float kBinsAUnit = 6.0f;  // bins some 10 degrees wide
  std::map<std::tuple<int, int, int>, int> counts;
  const float least = static_cast<float>(std::cos(45.0 * kDegree));
  const Eigen::Vector3f wanted = prior.cast<float>();
  for (const MapPoint& point : points) {
    if (point.normal.dot(wanted) < least) continue;
    const auto bin = [&](int i) { return static_cast<int>(std::lround(point.normal[i] * kBinsAUnit)); };
    ++counts[{bin(0), bin(1), bin(2)}];
  }
  if (counts.empty()) return prior;
  const auto fullest =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto& [x, y, z] = fullest->first;
  return Eigen::Vector3d(x, y, z).normalized();
}

}  // namespace

Eigen::Vector3d estimateUp(std::span<const MapPoint> points, std::span<const FrameRecord> frames) {
  Eigen::Vector3d up = commonestDirection(points, meanCameraUp(frames));
  constexpr int kRounds = 10;  // of a mean shift, each over the normals near the last mean
  const float near = static_cast<float>(std::cos(12.0 * kDegree));
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::Vector3f centre = up.cast<float>();
    for (const MapPoint& point : points) {
      if (point.normal.dot(centre) >= near) sum += point.normal.cast<double>();
    }
    if (sum.norm() < 1e-6) break;
    up = sum.normalized();
  }
  return up;
}

}  // namespace saccade
