#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/model_view.hpp"
#include "tracking/normal_equations.hpp"

namespace saccade {

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

/// Pairs each point with the model's surface behind the pixel it projects to and sums up the normal equations of the
/// point-to-plane distances, metres, with Tukey's weights (zero at the gate). `near` are the points within the distance
/// gate, `inliers` those whose normal agrees too. Same bytes for same arguments.
[[nodiscard]] NormalEquations linearize(const LivePoints& points, const ModelView& model, const Pose& T_MC,
                                        const PairingGates& gates);

/// The matrix H per unit of weight as it would be without noise in the normals, estimated around one pose.
///
/// Noise turns normals every way, which adds the same to all directions of H: a bare wall seems to hold the camera
/// sideways. In the products of the model's normal with that of the live point, whose noise is another, it averages
/// out. The smallest eigenvalue may come out a little below 0. Zero where nothing pairs. Uses some of the points.
[[nodiscard]] Matrix6 noiseFreeInformation(const LivePoints& points, const ModelView& model, const Pose& T_MC,
                                           const PairingGates& gates);

}  // namespace saccade
