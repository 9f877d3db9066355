#include "saccade/inspection/voxel_tile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "inspection/leaf_walk.hpp"

namespace saccade {
namespace {

constexpr int kMostCells = 64;  ///< along an edge of a tile

struct VoxelRecord {
  std::array<std::uint8_t, 3> cell{};
  std::uint8_t log2_edge = 0;
  std::array<std::uint8_t, 3> rgb{};
  std::uint8_t occupancy = 0;
  std::array<std::int8_t, 3> normal{};
  std::uint8_t open_faces = 0;
};
static_assert(sizeof(VoxelRecord) == 12);

/// Sums over the occupied leaves of a voxel.
struct LeafMeans {
  double volume = 0.0, red = 0.0, green = 0.0, blue = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  std::uint32_t expiry = 0;
  bool inhibited = false;
};

class VoxelEncoder {
 public:
  VoxelEncoder(const MapTree& map, const NodeKey& root, int voxel_depth)
      : map_(map), root_(root), voxel_depth_(voxel_depth), side_(1 << std::max(0, voxel_depth - root.depth)) {}

  std::string encode() {
    const MapNode node = findRoot();
    if (node && !node.isLeaf()) {
      if (side_ > kMostCells) {
        throw std::invalid_argument("a tile of " + std::to_string(side_) + " voxels a side, possible are 64");
      }
      const auto side = static_cast<std::size_t>(side_);
      taken_.assign(side * side * side, 0);
    }
    if (node) collect(node, root_);
    for (VoxelRecord& voxel : voxels_) voxel.open_faces = openFaces(voxel);
    return bytes();
  }

 private:
  [[nodiscard]] MapNode findRoot() const {
    MapNode node = map_.root;
    for (int depth = 0; node && depth < root_.depth; ++depth) {
      const int bit = MapTree::kDepth - 1 - depth;
      const LeafKey& key = root_.corner;
      const unsigned i = (key.x >> bit & 1u) | (key.y >> bit & 1u) << 1 | (key.z >> bit & 1u) << 2;
      if (node.isLeaf() || (node.childMask() >> i & 1u) == 0) return MapNode();
      node = node.child(i);
    }
    return node;
  }

  void collect(MapNode node, const NodeKey& key) {
    if (node.logOdds() < map_.occupied_log_odds) return;
    if (node.isLeaf() || key.depth == voxel_depth_) {
      addVoxel(node, key);
      return;
    }
    for (unsigned i = 0; i < 8; ++i) {
      if ((node.childMask() >> i & 1u) != 0) collect(node.child(i), childOf(key, i));
    }
  }

  void addVoxel(MapNode node, const NodeKey& key) {
    LeafMeans means;
    addLeaves(node, key.depth, means);
    VoxelRecord voxel;
    const int shift = MapTree::kDepth - voxel_depth_;
    const auto cell = [&](std::uint16_t part, std::uint16_t corner) {
      return static_cast<std::uint8_t>((part - corner) >> shift);
    };
    voxel.cell = {cell(key.corner.x, root_.corner.x), cell(key.corner.y, root_.corner.y),
                  cell(key.corner.z, root_.corner.z)};
    voxel.log2_edge = static_cast<std::uint8_t>(voxel_depth_ - key.depth);
    const auto mean = [&](double sum) { return static_cast<std::uint8_t>(std::lround(sum / means.volume)); };
    voxel.rgb = {mean(means.red), mean(means.green), mean(means.blue)};
    voxel.occupancy = static_cast<std::uint8_t>(std::lround(255.0 / (1.0 + std::exp(-node.logOdds()))));
    if (means.normal.norm() > 0.0) {
      const Eigen::Vector3d n = 127.0 * means.normal.normalized();
      for (int axis = 0; axis < 3; ++axis) {
        voxel.normal[static_cast<std::size_t>(axis)] = static_cast<std::int8_t>(std::lround(n[axis]));
      }
    }
    voxels_.push_back(voxel);
    ior_.push_back(means.expiry > 0 ? IorState(means.expiry, means.inhibited).bits() : 0u);
    if (voxel.log2_edge == 0 && !taken_.empty()) taken_[index(voxel.cell[0], voxel.cell[1], voxel.cell[2])] = 1;
  }

  void addLeaves(MapNode node, int depth, LeafMeans& means) const {
    if (node.logOdds() < map_.occupied_log_odds) return;
    if (!node.isLeaf()) {
      for (unsigned i = 0; i < 8; ++i) {
        if ((node.childMask() >> i & 1u) != 0) addLeaves(node.child(i), depth + 1, means);
      }
      return;
    }
    const LeafSurface surface = node.surface();
    const double volume = std::pow(8.0, MapTree::kDepth - depth);
    means.volume += volume;
    means.red += volume * surface.red;
    means.green += volume * surface.green;
    means.blue += volume * surface.blue;
    means.normal += volume * surface.normal().cast<double>();
    if (node.ior().expiry() > map_.now.value) means.expiry = std::max(means.expiry, node.ior().expiry());
    means.inhibited |= inhibited(node.ior(), map_.now);
  }

  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  }

  /// Coarse leaves have all faces open: they are few.
  [[nodiscard]] std::uint8_t openFaces(const VoxelRecord& voxel) const {
    if (voxel.log2_edge != 0 || taken_.empty()) return 0x3F;
    constexpr std::array<std::array<int, 3>, 6> kSteps = {
        {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
    unsigned open = 0;
    for (unsigned face = 0; face < 6; ++face) {
      const int x = voxel.cell[0] + kSteps[face][0], y = voxel.cell[1] + kSteps[face][1],
                z = voxel.cell[2] + kSteps[face][2];
      const bool inside = std::min({x, y, z}) >= 0 && std::max({x, y, z}) < side_;
      if (!inside || taken_[index(x, y, z)] == 0) open |= 1u << face;
    }
    return static_cast<std::uint8_t>(open);
  }

  [[nodiscard]] std::string bytes() const {
    std::string out = "SVT1";
    const auto put = [&](const void* data, std::size_t size) { out.append(static_cast<const char*>(data), size); };
    for (const std::uint16_t part : {root_.corner.x, root_.corner.y, root_.corner.z}) put(&part, sizeof part);
    out += static_cast<char>(root_.depth);
    out += static_cast<char>(voxel_depth_);
    const auto count = static_cast<std::uint32_t>(voxels_.size());
    put(&count, sizeof count);
    put(voxels_.data(), voxels_.size() * sizeof(VoxelRecord));
    put(ior_.data(), ior_.size() * sizeof(std::uint32_t));
    return out;
  }

  const MapTree& map_;
  NodeKey root_;
  int voxel_depth_;
  int side_;  ///< voxels along an edge of the tile
  std::vector<VoxelRecord> voxels_;
  std::vector<std::uint32_t> ior_;
  std::vector<std::uint8_t> taken_;
};

}  // namespace

std::string encodeVoxels(const MapTree& map, const NodeKey& root, int voxel_depth) {
  if (voxel_depth < kCoarsestVoxelDepth || voxel_depth > kFinestVoxelDepth) {
    throw std::invalid_argument("voxels of depth " + std::to_string(voxel_depth) + ", possible are 10 to 16");
  }
  return VoxelEncoder(map, root, std::max(voxel_depth, root.depth)).encode();
}

}  // namespace saccade
