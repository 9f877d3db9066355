#pragma once

#include <span>

#include <Eigen/Core>

#include "saccade/exchange/map_points.hpp"
#include "saccade/session/session_records.hpp"

namespace saccade {

/// Unit vector in W that points up, estimated: the commonest normal of the occupied leaves within 45 degrees of the
/// mean upward direction of the cameras (of +z where there are no poses, as OctoMap's maps have it). Tables and floors
/// are level, and people hold cameras upright. Without such normals: that mean direction itself.
[[nodiscard]] Eigen::Vector3d estimateUp(std::span<const MapPoint> points, std::span<const FrameRecord> frames);

}  // namespace saccade
