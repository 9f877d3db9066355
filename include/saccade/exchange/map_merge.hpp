#pragma once

#include <cstddef>

#include "saccade/core/frame.hpp"
#include "saccade/map/ior_map.hpp"

namespace saccade {

/// The map as another world frame has it: every leaf of the result takes what `map` holds at its centre, `T_WM` taking
/// points of the map's frame to the result's. Free regions stay coarse. With the identity and the same leaf size the
/// result is equal to the map, but pruned. Cost: about the surfaces' leaves, not the volume.
/// Throws std::invalid_argument if the pose is not finite or the settings are out of range.
[[nodiscard]] IorMap resampleMap(const IorMap& map, const Pose& T_WM, const IorMapConfig& config);

/// What a merge did.
struct MapMergeReport {
  std::size_t common = 0;  ///< finest or coarse leaves that both maps knew
  std::size_t lifted = 0;  ///< leaves whose memory was lifted because the maps disagree there
};

/// One map of two of the same world frame and leaf size, under `a`'s settings.
///
/// Occupancy: log-odds are added and clamped, as if both had been seen by one map; what one map does not know is taken
/// from the other. Attention: a leaf keeps the longer of its two remaining memories, counted in ticks from each map's
/// now, and is inhibited if the longer one inhibits (of equal ones, if either does). Where one map has a surface and
/// the other says free, the scene changed, and memory is lifted: the place is to be looked at again. Surfaces are
/// averaged by their observations. The tick is the sum of both: their logs then follow one another.
///
/// Symmetric up to rounding; an empty map at tick 0 changes nothing. Throws std::invalid_argument for leaves that
/// differ in size.
[[nodiscard]] IorMap mergeMaps(const IorMap& a, const IorMap& b, MapMergeReport* report = nullptr);

}  // namespace saccade
