#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "saccade/core/frame.hpp"
#include "saccade/exchange/map_points.hpp"

namespace saccade {

/// What an MRPT scene shows of a session.
struct SceneContent {
  std::span<const MapPoint> leaves;
  std::vector<Pose> path;                         ///< T_WC of the tracked frames in order
  std::vector<Eigen::AlignedBox3d> object_boxes;  ///< in W, metres
};

/// Whether this build has MRPT (Debian package libmrpt-opengl-dev).
[[nodiscard]] bool canWriteMrptScene();

/// Writes a `.3Dscene` for MRPT's SceneViewer3D: the leaves as voxels of their colour, the camera's path, a frame of
/// axes at W's origin, object boxes as wires. Throws IoError naming `path` if the file cannot be written whole, or if
/// this build has no MRPT.
void writeMrptScene(const SceneContent& content, const std::filesystem::path& path);

}  // namespace saccade
