#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

/// Means of curves over sequences.
namespace saccade {

[[nodiscard]] inline double meanOf(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Point by point, as far as the shortest curve goes. Empty without curves.
[[nodiscard]] inline std::vector<double> meanCurve(const std::vector<std::vector<double>>& curves) {
  std::vector<double> mean;
  if (curves.empty()) return mean;
  std::size_t length = curves.front().size();
  for (const std::vector<double>& curve : curves) length = std::min(length, curve.size());
  for (std::size_t i = 0; i < length; ++i) {
    double sum = 0.0;
    for (const std::vector<double>& curve : curves) sum += curve[i];
    mean.push_back(sum / static_cast<double>(curves.size()));
  }
  return mean;
}

}  // namespace saccade
