#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/model_view.hpp"

namespace saccade {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Live points of one level, camera frame C, in separate arrays that are padded to whole blocks with weight 0.
struct LivePoints {
  static constexpr std::size_t kBlock = 128;

  std::array<std::vector<float>, 3> position;
  std::array<std::vector<float>, 3> normal;
  std::vector<float> weight;
  std::size_t count = 0;  ///< real points
  double mean_range_m = 1.0;

  /// Takes every `stride`-th pixel that has a vertex and a normal. Reuses the arrays.
  void select(const DepthMaps& depth, int stride);
};

struct PairingGates {
  double distance_m = 0.03;
  double normal_cosine = 0.8;
};

/// Sum of squared point-to-plane distances around one pose, to second order. The unknown is (turn, shift) of a motion
/// applied to the points in the model's frame M: p_M -> turn x p_M + p_M + shift.
struct NormalEquations {
  Matrix6 H = Matrix6::Zero();
  Vector6 b = Vector6::Zero();  ///< minus the gradient: the step solves H * step = b
  double weight = 0.0;
  double weighted_square = 0.0;  ///< m^2
  double met = 0.0;              ///< points that project onto a surface of the model
  double inliers = 0.0;          ///< those within the gates
};

/// Pairs each point with the model's surface behind the pixel it projects to and sums up the normal equations, with
/// Tukey's weights (zero at the gate). Same bytes for same arguments.
void linearize(const LivePoints& points, const ModelView& model, const Pose& T_MC, const PairingGates& gates,
               NormalEquations& sums);

/// The matrix H per unit of weight as it would be without noise in the normals, estimated around one pose.
///
/// Noise turns normals every way, which adds the same to all directions of H: a bare wall seems to hold the camera
/// sideways. In the products of the model's normal with that of the live point, whose noise is another, it averages
/// out. The smallest eigenvalue may come out a little below 0. Zero where nothing pairs. Uses some of the points.
[[nodiscard]] Matrix6 noiseFreeInformation(const LivePoints& points, const ModelView& model, const Pose& T_MC,
                                           const PairingGates& gates);

}  // namespace saccade
