#pragma once

#include <span>

#include <Eigen/Geometry>

#include "saccade/map/map_cursor.hpp"
#include "saccade/session/session_records.hpp"

namespace saccade {

/// Where a map lies in the world and which way is up in it: what pictures are composed by.
struct SceneFrame {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();  ///< unit length
  Eigen::AlignedBox3d box;  ///< of the occupied leaves but for a few strays; empty for a map without any
  [[nodiscard]] bool empty() const { return box.isEmpty(); }
};

/// Finds up (estimateUp()) and extent of a map that was seen from `frames`. Cost: every occupied leaf.
[[nodiscard]] SceneFrame findSceneFrame(const MapTree& map, std::span<const FrameRecord> frames);

}  // namespace saccade
