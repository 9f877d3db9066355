#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace saccade {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A weighted sum of squared residuals around one pose, to second order. The unknown is (turn, shift) of a motion
/// applied to the points in the model's frame M: p_M -> turn x p_M + p_M + shift.
struct NormalEquations {
  Matrix6 H = Matrix6::Zero();
  Vector6 b = Vector6::Zero();  ///< minus the gradient: the step solves H * step = b
  double weight = 0.0;
  double weighted_residual = 0.0;
  double weighted_square = 0.0;
  double met = 0.0;      ///< residuals that there are at all
  double near = 0.0;     ///< of these, small enough
  double inliers = 0.0;  ///< of these, the ones that count
};

/// Rows of the linear system of one block of points: residual - j * step is to be small. What does not count has
/// weight, row and residual 0.
struct ResidualRows {
  static constexpr std::size_t kBlock = 128;

  alignas(32) float j[6][kBlock];
  alignas(32) float residual[kBlock];
  alignas(32) float weight[kBlock];
  alignas(32) float met[kBlock];
  alignas(32) float near[kBlock];
  alignas(32) float inlier[kBlock];
};

/// Adds up blocks of rows. Single precision within a block, double beyond; same bytes for same rows.
class RowSums {
 public:
  void add(const ResidualRows& rows);
  [[nodiscard]] NormalEquations sums() const;

  static constexpr std::size_t kSums = 21 + 6 + 6;  ///< upper triangle of H, b, the single numbers in their order

 private:
  double total_[kSums] = {};
};

}  // namespace saccade
