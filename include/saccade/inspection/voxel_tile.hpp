#pragma once

#include <string>

#include "saccade/map/leaf_key.hpp"
#include "saccade/map/map_cursor.hpp"

/// The map as the page of `saccade view` draws it: voxels of any depth of the octree, tile by tile.
namespace saccade {

/// Coarsest and finest depth of voxels: 16 are the leaves themselves, each step up doubles their edge.
inline constexpr int kCoarsestVoxelDepth = 10;
inline constexpr int kFinestVoxelDepth = MapTree::kDepth;

/// The occupied voxels of depth `voxel_depth` below the node `root` of `map`, in Morton order, as bytes, little-endian.
///
/// Header, 16 bytes: "SVT1", corner of the root as 3 × uint16, its depth, voxel_depth, number n of voxels as uint32.
/// Then n records of 12 bytes: cell in the tile x, y, z (voxels of `voxel_depth`), log2 of the edge in cells (above 0
/// for coarse leaves), red, green, blue, occupancy (0..1 as 0..255), normal x, y, z (times 127), open faces (bits -x +x
/// -y +y -z +z: no occupied voxel of this tile there). Then n × uint32: IorState::bits().
///
/// A voxel above the leaves has the means of colour and normal of its occupied leaves, their largest occupancy and the
/// longest memory, inhibited if any of them is. A node that the map does not have gives a header with n = 0.
/// Throws std::invalid_argument unless kCoarsestVoxelDepth <= voxel_depth <= kFinestVoxelDepth, and for a root whose
/// tile would be more than 64 voxels a side (the tiles of a session are not).
[[nodiscard]] std::string encodeVoxels(const MapTree& map, const NodeKey& root, int voxel_depth);

}  // namespace saccade
