#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace saccade {

/// Address of a finest leaf: its index along x, y, z of the world, 0..65535, as OctoMap's `OcTreeKey`.
///
/// The leaf spans [(x - 32768) * leaf_size_m, (x - 32767) * leaf_size_m) along x, and so on. A type of its own, so that
/// it is never mixed up with pixels or ticks.
struct LeafKey {
  std::uint16_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const LeafKey&, const LeafKey&) = default;

  /// The key as one number, x in the highest of the 48 bits: to sort, hash and store.
  [[nodiscard]] constexpr std::uint64_t packed() const {
    return static_cast<std::uint64_t>(x) << 32 | static_cast<std::uint64_t>(y) << 16 | z;
  }
  /// Inverse of packed().
  [[nodiscard]] static constexpr LeafKey fromPacked(std::uint64_t value) {
    return {static_cast<std::uint16_t>(value >> 32), static_cast<std::uint16_t>(value >> 16),
            static_cast<std::uint16_t>(value)};
  }
};

/// Root of a subtree: the key of its lowest corner, low bits zero, and its depth (0 the whole map, 16 a finest leaf).
struct NodeKey {
  LeafKey corner;
  int depth = 0;
  friend auto operator<=>(const NodeKey&, const NodeKey&) = default;
};

}  // namespace saccade

template <>
struct std::hash<saccade::LeafKey> {
  std::size_t operator()(const saccade::LeafKey& key) const noexcept {
    std::uint64_t h = key.packed() * 0x9E3779B97F4A7C15ull;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};
