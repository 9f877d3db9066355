#include "saccade/evaluation/local_alignment.hpp"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Geometry>

namespace saccade {
namespace {

constexpr double kLookAhead_m = 2.0;

double squaredDistance(const Pose& a, const Pose& b) {
  const Eigen::Vector3d ahead(0.0, 0.0, kLookAhead_m);
  return (a.translation() - b.translation()).squaredNorm() + (a * ahead - b * ahead).squaredNorm();
}

}  // namespace

LocalAlignment::LocalAlignment(std::vector<PosePair> pairs) : pairs_(std::move(pairs)) {
  if (pairs_.empty()) throw std::invalid_argument("LocalAlignment: expected pairs of poses, found none");
}

Pose LocalAlignment::toEstimate(const Pose& truth) const {
  std::vector<const PosePair*> nearest;
  nearest.reserve(pairs_.size());
  for (const PosePair& pair : pairs_) nearest.push_back(&pair);
  const std::size_t count = std::min(kNearest, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count), nearest.end(),
                    [&](const PosePair* a, const PosePair* b) {
                      return squaredDistance(a->truth.T_WC, truth) < squaredDistance(b->truth.T_WC, truth);
                    });
  nearest.resize(count);

  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector4d turn = Eigen::Vector4d::Zero();  // mean of unit quaternions of one sign: they lie close together
  for (const PosePair* pair : nearest) {
    const Pose carried = pair->estimate.T_WC * (pair->truth.T_WC.inverse() * truth);
    position += carried.translation();
    const Eigen::Vector4d quaternion = Eigen::Quaterniond(carried.linear()).coeffs();
    turn += turn.dot(quaternion) < 0.0 ? Eigen::Vector4d(-quaternion) : quaternion;
  }
  Pose mean = Pose::Identity();
  mean.translation() = position / static_cast<double>(count);
  mean.linear() = Eigen::Quaterniond(turn.normalized()).toRotationMatrix();
  return mean;
}

}  // namespace saccade
