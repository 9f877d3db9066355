#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "saccade/map/ior_law.hpp"
#include "saccade/map/leaf_key.hpp"
#include "saccade/map/leaf_surface.hpp"

/// Read-only traversal of the map's octree without OctoMap's headers, for rendering, session and inspection.
namespace saccade {

/// Where the fields of a node lie in memory; a unit test holds `IorOcTreeNode` to it.
///
/// The children of a node form one *family*: a block of 256 bytes, aligned to 64, with OctoMap's array of eight
/// pointers first and the eight nodes after it, so that the address of a child follows from its number without reading
/// a pointer.
struct NodeLayout {
  static constexpr std::size_t kChildren = 0;  ///< pointer to the family, null for a leaf
  static constexpr std::size_t kLogOdds = 8;
  static constexpr std::size_t kIor = 12;
  static constexpr std::size_t kSurface = 16;    ///< leaf: LeafSurface
  static constexpr std::size_t kChildMask = 16;  ///< inner node: bit i set = child i exists
  static constexpr std::size_t kNodeBytes = 24;
  static constexpr std::size_t kFamilyNodes = 64;  ///< the nodes start here in the family
  static constexpr std::size_t kFamilyBytes = kFamilyNodes + 8 * kNodeBytes;
};

/// Handle of one node; as cheap as a pointer, valid until the map is changed.
///
/// Child i covers the upper half along x if i & 1, along y if i & 2, along z if i & 4 (OctoMap's order). Thread rule:
/// any number of readers while nobody writes.
class MapNode {
 public:
  MapNode() = default;
  explicit MapNode(const void* node) : node_(static_cast<const std::byte*>(node)) {}

  [[nodiscard]] explicit operator bool() const { return node_ != nullptr; }
  [[nodiscard]] bool isLeaf() const { return load<const std::byte*>(NodeLayout::kChildren) == nullptr; }
  /// Which children exist, as bits; only for inner nodes.
  [[nodiscard]] unsigned childMask() const { return load<std::uint8_t>(NodeLayout::kChildMask); }
  /// Child i of an inner node; it must exist, see childMask().
  [[nodiscard]] MapNode child(unsigned i) const {
    return MapNode(load<const std::byte*>(NodeLayout::kChildren) + NodeLayout::kFamilyNodes +
                   i * NodeLayout::kNodeBytes);
  }
  /// The whole family of an inner node, for prefetching.
  [[nodiscard]] const void* family() const { return load<const std::byte*>(NodeLayout::kChildren); }

  /// Log-odds of occupancy; of an inner node, the largest below it.
  [[nodiscard]] float logOdds() const { return load<float>(NodeLayout::kLogOdds); }
  /// Attention memory. Of an inner node: `inhibited(ior(), now)` false means that no leaf below it is inhibited.
  [[nodiscard]] IorState ior() const { return IorState::fromBits(load<std::uint32_t>(NodeLayout::kIor)); }
  /// Colour, normal and count; only for leaves.
  [[nodiscard]] LeafSurface surface() const { return load<LeafSurface>(NodeLayout::kSurface); }

  friend bool operator==(const MapNode&, const MapNode&) = default;

 private:
  template <typename T>
  [[nodiscard]] T load(std::size_t offset) const {
    T value;
    std::memcpy(&value, node_ + offset, sizeof(T));
    return value;
  }
  const std::byte* node_ = nullptr;
};

/// What a traversal must know of the map besides its nodes. Valid until the map is changed.
struct MapTree {
  static constexpr int kDepth = 16;         ///< depth of the finest leaves; the root is at depth 0
  static constexpr int kCentreKey = 32768;  ///< key of the leaf whose lower corner is the world's origin
  MapNode root;                             ///< null while the map is empty
  double leaf_size_m = 0.0;                 ///< edge of a finest leaf
  float occupied_log_odds = 0.0f;           ///< a leaf is occupied from this value on
  Tick now;

  /// Edge of the nodes at `depth`, metres.
  [[nodiscard]] double nodeSize_m(int depth) const { return leaf_size_m * static_cast<double>(1 << (kDepth - depth)); }
};

}  // namespace saccade
