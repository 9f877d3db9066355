#include "saccade/discovery/support_planes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>

namespace saccade {
namespace {

// A patch seen at a flatter angle than this is measured as if it were seen at it: its normal is too uncertain.
constexpr double kSmallestCosine = 0.2;
// Thickness (standard deviation) that sensor noise alone gives a plane, at 1 m; it grows with z².
constexpr double kFlat_m = 0.006;
constexpr double kNoisePerSquareMetre = 0.004;

Eigen::Vector3d meanPoint(const SegmentSums& sums) {
  return Eigen::Vector3d(sums.vertex[0], sums.vertex[1], sums.vertex[2]) / std::max(1, sums.depth_count);
}

Eigen::Vector3d meanNormal(const SegmentSums& sums) {
  const Eigen::Vector3d n(sums.normal[0], sums.normal[1], sums.normal[2]);
  const double length = n.norm();
  return length > 0.0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d(0.0, 0.0, 0.0);
}

double noise(double z_m) {
  return kNoisePerSquareMetre * z_m * z_m;
}

}  // namespace

double metricArea(const SegmentSums& sums, const PinholeCamera& camera) {
  if (sums.depth_count == 0) return 0.0;
  const Eigen::Vector3d p = meanPoint(sums), n = meanNormal(sums);
  const double cosine = p.norm() > 0.0 ? std::abs(n.dot(p.normalized())) : 1.0;
  const double pixel_m2 = p.z() * p.z() / (camera.fx * camera.fy);
  return sums.depth_count * pixel_m2 / std::max(cosine, kSmallestCosine);
}

void SupportPlanes::build(const SegmentTable& surfaces, const PinholeCamera& camera, const SupportPlaneConfig& config) {
  planes_.clear();
  plane_of_.assign(static_cast<std::size_t>(surfaces.count()), kNoPlane);
  if (!surfaces.hasDepth()) return;

  std::vector<double> area(plane_of_.size());
  for (std::size_t i = 0; i < area.size(); ++i) {
    area[i] = metricArea(surfaces.sums(static_cast<std::int32_t>(i)), camera);
  }
  std::vector<std::int32_t> order(plane_of_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return area[static_cast<std::size_t>(a)] > area[static_cast<std::size_t>(b)];
  });

  for (const std::int32_t seed : order) {
    const auto s = static_cast<std::size_t>(seed);
    if (area[s] < config.min_area_m2) break;
    const SegmentSums& sums = surfaces.sums(seed);
    if (plane_of_[s] != kNoPlane || sums.normal_count == 0) continue;
    const Eigen::Vector3d p = meanPoint(sums), n = meanNormal(sums);
    Eigen::Matrix3d scatter;
    scatter << sums.scatter[0], sums.scatter[1], sums.scatter[2], sums.scatter[1], sums.scatter[3], sums.scatter[4],
        sums.scatter[2], sums.scatter[4], sums.scatter[5];
    const Eigen::Matrix3d covariance = scatter / sums.depth_count - p * p.transpose();
    const double thickness_m = std::sqrt(std::max(0.0, n.dot(covariance * n)));
    if (thickness_m > kFlat_m + noise(p.z())) continue;

    Plane plane{n, n.dot(p), area[s]};
    const auto id = static_cast<std::int32_t>(planes_.size());
    for (const std::int32_t other : order) {
      const auto o = static_cast<std::size_t>(other);
      const SegmentSums& candidate = surfaces.sums(other);
      if (plane_of_[o] != kNoPlane || candidate.depth_count == 0) continue;
      const Eigen::Vector3d q = meanPoint(candidate);
      const double distance_m = std::abs(n.dot(q) - plane.offset_m);
      const bool aligned = n.dot(meanNormal(candidate)) > std::cos(config.max_angle_rad);
      if (other != seed && (!aligned || distance_m > config.max_distance_m + noise(q.z()))) continue;
      plane_of_[o] = id;
      if (other != seed) plane.area_m2 += area[o];
    }
    planes_.push_back(plane);
  }
}

double SupportPlanes::height(const Eigen::Vector3d& p_C) const {
  double lowest = 0.0;
  for (const Plane& plane : planes_) {
    const double height = plane.normal.dot(p_C) - plane.offset_m;
    if (height > 0.0 && (lowest == 0.0 || height < lowest)) lowest = height;
  }
  return lowest;
}

}  // namespace saccade
