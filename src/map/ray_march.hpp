#pragma once

#include <cstdint>

#include "saccade/map/surface_volume.hpp"

namespace saccade {

/// The visible bricks as a dense array with a margin of one brick; positions are in samples from its first brick.
struct BrickGrid {
  const SurfaceBrick* const* bricks;  ///< one of unknown samples stands where there is none
  const std::uint8_t* no_surface;     ///< by brick: 1 where there is no brick, or none with a surface
  std::int32_t row, slice;            ///< steps to the next brick in y and z
  float high[3];                      ///< positions up to here have all their neighbours in the array, from 1 on
};

/// The rays of one row of an image: pixel u at depth z is at origin + z * (start + u * step), in samples.
struct RayRow {
  float origin[3];
  float start[3];
  float step[3];
  float rotation[9];   ///< by rows, from the grid's axes to those of the normals
  float band_samples;  ///< truncation of the distances
};

/// What eight neighbouring pixels see. Depth 0: nothing.
struct EightHits {
  alignas(32) float depth[8];
  alignas(32) float normal[3][8];
};

/// Follows the rays of pixels u ... u + 7 from depth `near` to `far`, each its own, to the first change from before to
/// behind a surface: steps as long as the distance allows, then the secant and one Newton step.
void marchEight(const BrickGrid& grid, const RayRow& rays, int u, const float* near, const float* far, EightHits& hits);

}  // namespace saccade
