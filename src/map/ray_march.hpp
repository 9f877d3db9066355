#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saccade/map/surface_volume.hpp"

namespace saccade {

/// The part of a volume that rays can meet a surface in, as a dense array of bricks with a margin of one; positions are
/// in samples from its first brick. A brick that a surface runs through is copied when the first ray enters it,
/// together with the first samples of its upper neighbours, so that the eight samples around any point lie at fixed
/// distances.
struct SurfaceGrid {
  static constexpr int kEdge = SurfaceBrick::kSide + 1;
  static constexpr int kCopy = kEdge * kEdge * kEdge;  ///< samples of a copied brick, x fastest
  static constexpr std::int32_t kNoSurface = 0;        ///< `copies` where no surface runs through a brick
  static constexpr std::int32_t kNotCopied = -1;       ///< `copies` where one does that was not entered yet

  const SurfaceBrick* const* bricks;  ///< one of unknown samples stands where there is none
  std::int32_t* copies;               ///< by brick: where its copy starts in `samples`
  std::int16_t* samples;              ///< distances as a brick has them; first those of a brick that is unknown
  std::int32_t end;                   ///< of the copies; there is room for all bricks that want one
  std::int32_t row, slice;            ///< steps to the next brick in y and z
  float high[3];                      ///< positions up to here have all their neighbours in the array, from 1 on
};

/// The rays of a camera: pixel (u, v) at depth z is at origin + z * (start + u * column + v * row), in samples.
struct RayFan {
  float origin[3];
  float start[3];
  float column[3], row[3];
  float rotation[9];   ///< by rows, from the grid's axes to those of the normals
  float band_samples;  ///< truncation of the distances
  float slice_m;       ///< depth of a slice, see RayBounds::slices
};

/// Rays on their way: which pixel's, and how far they got. All take a step in turn, so that none waits for the memory
/// that another one reads. Recycled from call to call.
class RayQueue {
 public:
  /// Has room for `most` rays, and none.
  void reset(std::size_t most);

  /// Adds the ray of pixel (u, v) from depth `near` on if it can meet a surface, which is where `slices` tell (see
  /// RayBounds). Pixels are below 32768.
  void add(int u, int v, float near, std::int32_t slices) {
    pixel_[count_] = u | v << 16;
    slices_[count_] = slices;
    depth_[count_] = near;
    count_ += slices != 0 ? 1 : 0;
  }

  /// Images that show what the rays meet; rows are so many floats apart.
  struct View {
    float* depth_m;
    float* normals;
    std::size_t depth_stride, normal_stride;
  };
  /// Follows all rays to the first change from before to behind a surface, at most to depth `far`, and writes depth and
  /// normal of those that meet one: steps as long as the distance allows, then one Newton step, or the secant if a step
  /// went too far.
  void march(SurfaceGrid& grid, const RayFan& fan, float far, const View& view);

 private:
  struct Rays {
    std::int32_t* pixel;  // u in the lower half
    std::int32_t* slices;
    float *depth, *end;  // of the next look, and of the ray
    float* direction[3];
    float* sample;             // depth after which the ray is one sample further
    float *before, *f_before;  // last depth before the surface, and its distance
    float* behind;             // depth behind it, while refining
  };
  static constexpr std::size_t kFields = 9;  // floats of a ray
  static void begin(const SurfaceGrid& grid, const RayFan& fan, float far, const Rays& rays, std::size_t count);
  static void step(SurfaceGrid& grid, const RayFan& fan, const Rays& rays, std::size_t count);
  static std::size_t closeUp(const RayFan& fan, const Rays& rays, std::size_t count, const View& view);

  std::size_t count_ = 0, room_ = 0;
  std::vector<std::int32_t> pixel_, slices_;
  std::vector<float> depth_, fields_;
};

}  // namespace saccade
