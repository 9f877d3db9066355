#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "saccade/map/ior_map.hpp"
#include "saccade/map/leaf_key.hpp"

/// The map as byte strings, one per tile: subtrees at a fixed depth. Compression, checksums and files are the
/// session's.
namespace saccade {

/// Depth of the tiles' roots unless said otherwise: 64 leaves along each edge, 0.64 m at 1 cm.
inline constexpr int kTileDepth = 10;

/// One tile as it is kept in a session.
struct MapTile {
  NodeKey root;
  std::vector<std::byte> data;
};

/// Roots of the tiles that together hold the whole map, in Morton order: the nodes at `depth`, and the coarse leaves
/// above it. Throws std::invalid_argument unless 0 <= depth <= 16.
[[nodiscard]] std::vector<NodeKey> listTiles(const IorMap& map, int depth = kTileDepth);

/// The subtree at `root` as bytes: 3 a family, 4 a leaf, 12 more where the leaf remembers anything. Equal subtrees give
/// equal bytes. Throws std::invalid_argument where the map has no such node.
[[nodiscard]] std::vector<std::byte> encodeTile(const IorMap& map, const NodeKey& root);

/// The same bytes of the subtree under `node`, put behind what `out` holds; the number of its leaves.
std::size_t appendTile(MapNode node, std::vector<std::byte>& out);

/// One tile of a map and whether it may have changed.
struct TileChange {
  NodeKey root;
  MapNode node;  ///< valid until the map is changed
  bool changed = false;
};

/// The tiles as listTiles() lists them, each with whether it may have changed since the last call (at the first one:
/// all). Tiles that are one leaf always count as changed. Cost: the nodes above the tiles.
[[nodiscard]] std::vector<TileChange> takeTileChanges(IorMap& map, int depth = kTileDepth);

/// The same without ending the time since the last call.
[[nodiscard]] std::vector<TileChange> tileChanges(const IorMap& map, int depth = kTileDepth);

/// The space that a node covers, in W, metres.
[[nodiscard]] Eigen::AlignedBox3d boxOf(const NodeKey& node, double leaf_size_m);

/// All tiles of the map.
[[nodiscard]] std::vector<MapTile> encodeTiles(const IorMap& map, int depth = kTileDepth);

/// Takes the tile at `root` out of the map, as if it had never been there. Throws std::invalid_argument where the map
/// has no such inner node: a tile that is one leaf may become one with its neighbours at any time and stays.
void removeTile(IorMap& map, const NodeKey& root);

/// Puts a tile into the map where it has none; its inner nodes count as unchanged. Throws IoError as restoreMap().
void insertTile(IorMap& map, const MapTile& tile, const std::filesystem::path& source);

/// The number of leaves in a tile. Throws IoError naming `source` unless restoreMap() would take it, looked at alone.
std::size_t checkTile(const MapTile& tile, const std::filesystem::path& source);

/// A map with the given tiles and tick, equal to the one they were made from if the config is the same.
///
/// Every byte is checked before it is used. Throws IoError naming `source` for tiles that are damaged, foreign, overlap
/// or lie outside the key space.
[[nodiscard]] IorMap restoreMap(const IorMapConfig& config, std::span<const MapTile> tiles, Tick now,
                                const std::filesystem::path& source);

}  // namespace saccade
