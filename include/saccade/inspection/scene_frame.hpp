#pragma once

#include <Eigen/Geometry>

#include "saccade/map/map_cursor.hpp"

namespace saccade {

/// Where a map lies in the world and which way is up in it: what pictures are composed by.
struct SceneFrame {
  Eigen::Vector3d up_W = -Eigen::Vector3d::UnitY();  ///< unit length
  Eigen::AlignedBox3d box;  ///< of the occupied leaves but for a few strays; empty for a map without any
  [[nodiscard]] bool empty() const { return box.isEmpty(); }
};

/// Finds up and extent of a map. Up is the direction of most surface area within 60 degrees of the first camera's own
/// up (-y of W): floors and table tops. Where no leaf there has a normal it is that direction itself.
/// Cost: every occupied leaf.
[[nodiscard]] SceneFrame findSceneFrame(const MapTree& map);

}  // namespace saccade
