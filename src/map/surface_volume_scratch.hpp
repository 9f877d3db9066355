#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "map/brick_fusion.hpp"
#include "map/ray_bounds.hpp"
#include "map/ray_march.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {

/// What the algorithms of a SurfaceVolume recycle from call to call.
struct SurfaceVolume::Scratch {
  Scratch() { unknown.distance.fill(SurfaceBrick::kUnknownDistance); }

  /// Bricks that touch the frustum of the last findVisible(), and their centres in that camera's frame.
  std::vector<std::int32_t> visible;
  std::vector<Eigen::Vector3f> centres;

  /// allocateBand(): bricks met by the rays of one row, and those that were found last.
  std::vector<BrickPosition> met, known;

  /// integrate(): which of `visible` are not hidden.
  BrickFusion fusion;
  std::vector<std::int32_t> reached;

  /// rayCast(): bricks of the visible box as a dense array with a margin of one brick, `unknown` where there is none,
  /// and those of them that a surface runs through, see SurfaceGrid.
  std::vector<const SurfaceBrick*> directory;
  std::vector<std::int32_t> copies;
  std::vector<std::int16_t> samples;
  SurfaceBrick unknown{};
  std::vector<std::size_t> filled, surface;
  Eigen::Vector3i origin = Eigen::Vector3i::Zero();
  Eigen::Vector3i extent = Eigen::Vector3i::Zero();
  RayBounds bounds;
  RayQueue rays;
};

/// The 2 x 2 x 2 blocks of a brick that hold a sample close behind a surface, as bits (see RayBounds).
[[nodiscard]] std::uint64_t blocksBehind(const SurfaceBrick& brick, double band_samples);

/// Throws std::invalid_argument unless `pose` is finite and its translation fits the brick grid.
inline void requireUsablePose(const Pose& pose, const char* name) {
  constexpr double kFarthest_m = 1e5;
  if (!pose.matrix().allFinite() || pose.translation().norm() > kFarthest_m) {
    throw std::invalid_argument(std::string(name) + " must be finite and within 1e5 m, its translation is " +
                                std::to_string(pose.translation().x()) + " " + std::to_string(pose.translation().y()) +
                                " " + std::to_string(pose.translation().z()));
  }
}

}  // namespace saccade
