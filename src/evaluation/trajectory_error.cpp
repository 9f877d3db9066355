#include "saccade/evaluation/trajectory_error.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace saccade {
namespace {

bool earlier(const StampedPose& pose, double stamp_s) {
  return pose.stamp_s < stamp_s;
}

double rootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<PosePair> associate(const std::vector<StampedPose>& estimate, const std::vector<StampedPose>& truth,
                                double max_gap_s) {
  std::vector<PosePair> pairs;
  if (estimate.empty()) return pairs;
  for (const StampedPose& pose : truth) {
    auto next = std::lower_bound(estimate.begin(), estimate.end(), pose.stamp_s, earlier);
    if (next == estimate.end() ||
        (next != estimate.begin() && pose.stamp_s - std::prev(next)->stamp_s <= next->stamp_s - pose.stamp_s)) {
      --next;
    }
    if (std::abs(next->stamp_s - pose.stamp_s) <= max_gap_s) pairs.push_back({*next, pose});
  }
  return pairs;
}

Pose alignToTruth(const std::vector<PosePair>& pairs) {
  Pose aligned = Pose::Identity();
  if (pairs.empty()) return aligned;
  Eigen::Vector3d mean_estimate = Eigen::Vector3d::Zero(), mean_truth = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    mean_estimate += pair.estimate.T_WC.translation();
    mean_truth += pair.truth.T_WC.translation();
  }
  mean_estimate /= static_cast<double>(pairs.size());
  mean_truth /= static_cast<double>(pairs.size());
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    correlation +=
        (pair.truth.T_WC.translation() - mean_truth) * (pair.estimate.T_WC.translation() - mean_estimate).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  aligned.linear() = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  aligned.translation() = mean_truth - aligned.linear() * mean_estimate;
  return aligned;
}

AbsoluteError absoluteError(const std::vector<PosePair>& pairs) {
  const Pose aligned = alignToTruth(pairs);
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    errors.push_back((aligned * pair.estimate.T_WC.translation() - pair.truth.T_WC.translation()).norm());
  }
  AbsoluteError result;
  result.matched = static_cast<int>(pairs.size());
  if (errors.empty()) return result;
  result.rmse_m = rootMeanSquare(errors);
  result.median_m = median(errors);
  for (const double error : errors) {
    result.mean_m += error / static_cast<double>(errors.size());
    result.max_m = std::max(result.max_m, error);
  }
  return result;
}

RelativeError relativeError(const std::vector<PosePair>& pairs, double delta_s) {
  RelativeError result;
  if (pairs.size() < 2) return result;
  std::vector<double> intervals, translations, rotations;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    intervals.push_back(pairs[i].truth.stamp_s - pairs[i - 1].truth.stamp_s);
  }
  const double tolerance_s = median(intervals) / 2.0 + 1e-9;
  std::size_t j = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double wanted = pairs[i].truth.stamp_s + delta_s;
    j = std::max(j, i + 1);
    while (j + 1 < pairs.size() &&
           std::abs(pairs[j + 1].truth.stamp_s - wanted) <= std::abs(pairs[j].truth.stamp_s - wanted)) {
      ++j;
    }
    if (j >= pairs.size() || std::abs(pairs[j].truth.stamp_s - wanted) > tolerance_s) continue;
    const Pose truth = pairs[i].truth.T_WC.inverse() * pairs[j].truth.T_WC;
    const Pose estimate = pairs[i].estimate.T_WC.inverse() * pairs[j].estimate.T_WC;
    const Pose error = truth.inverse() * estimate;
    translations.push_back(error.translation().norm());
    rotations.push_back(std::abs(Eigen::AngleAxisd(error.linear()).angle()));
  }
  result.pairs = static_cast<int>(translations.size());
  result.translation_rmse_m = rootMeanSquare(translations);
  result.rotation_rmse_rad = rootMeanSquare(rotations);
  return result;
}

}  // namespace saccade
