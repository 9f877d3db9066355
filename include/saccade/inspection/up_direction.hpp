#pragma once

#include <span>

#include <Eigen/Core>

#include "saccade/map/map_cursor.hpp"
#include "saccade/session/session_records.hpp"

namespace saccade {

/// Unit vector in W that points up, estimated: the direction that most occupied area faces within 45 degrees of the
/// mean upward direction of the cameras (of +z where there are no poses, as OctoMap's maps have it). Tables and floors
/// are level, and people hold cameras upright. Without such normals: that mean direction itself.
/// Cost: every occupied leaf.
[[nodiscard]] Eigen::Vector3d estimateUp(const MapTree& map, std::span<const FrameRecord> frames);

}  // namespace saccade
