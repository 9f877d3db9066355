#pragma once

#include <cstddef>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/tracking/intensity_pyramid.hpp"
#include "saccade/tracking/photometric_reference.hpp"
#include "tracking/normal_equations.hpp"

namespace saccade {

/// A live frame whose grey values are compared with a reference's, and where the two are.
struct PhotometricPair {
  const PhotometricReference::State& reference;
  const IntensityPyramid& live;
  const DepthMaps& depth;  ///< of the live frame: what it shows nearer or farther is another surface
  Pose T_MR;               ///< the reference in the model's frame
};

/// Projects each point of the reference into the live frame at `T_MC` and sums up the normal equations of the
/// differences of grey values less `brightness`, with Tukey's weights, which are zero from `gate` grey levels. The
/// unknown is as for linearize(). Texture's slope is that in the reference, which is the same surface's (inverse
/// compositional, Baker and Matthews 2004).
[[nodiscard]] NormalEquations linearizePhotometric(const PhotometricPair& pair, std::size_t level, const Pose& T_MC,
                                                   double brightness, double gate);

}  // namespace saccade
