#pragma once

#include "saccade/core/frame.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {

/// Adds the surface of `from` to `into`, whose frame `T_IF` takes its points to: signed distances are averaged by their
/// weights. Samples are interpolated where the frames differ, and taken one by one where they are the same and the
/// cells too. Cost: the bricks of `from`.
void mergeSurface(const SurfaceVolume& from, const Pose& T_IF, SurfaceVolume& into);

}  // namespace saccade
