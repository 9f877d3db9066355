#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saccade/map/leaf_key.hpp"

namespace saccade {

/// Interleaves the low 21 bits of x, y and z, x lowest: sorting by it is the order of OctoMap's children.
[[nodiscard]] inline std::uint64_t mortonCode(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const auto spread = [](std::uint64_t bits) {
    bits &= 0x1FFFFF;
    bits = (bits | bits << 32) & 0x1F00000000FFFF;
    bits = (bits | bits << 16) & 0x1F0000FF0000FF;
    bits = (bits | bits << 8) & 0x100F00F00F00F00F;
    bits = (bits | bits << 4) & 0x10C30C30C30C30C3;
    return (bits | bits << 2) & 0x1249249249249249;
  };
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

[[nodiscard]] inline std::uint64_t mortonCode(const LeafKey& key) {
  return mortonCode(key.x, key.y, key.z);
}

/// Inverse of mortonCode() for keys.
[[nodiscard]] inline LeafKey keyOfMortonCode(std::uint64_t code) {
  const auto gather = [](std::uint64_t bits) {
    bits &= 0x1249249249249249;
    bits = (bits | bits >> 2) & 0x10C30C30C30C30C3;
    bits = (bits | bits >> 4) & 0x100F00F00F00F00F;
    bits = (bits | bits >> 8) & 0x1F0000FF0000FF;
    bits = (bits | bits >> 16) & 0x1F00000000FFFF;
    return static_cast<std::uint16_t>(bits | bits >> 32);
  };
  return {gather(code), gather(code >> 1), gather(code >> 2)};
}

/// Something that lies somewhere else, and the Morton code to sort it by.
struct MortonCoded {
  std::uint64_t code;
  std::uint32_t index;
};

/// Sorts by code; equal codes stay in their order. Only the lowest `bits` of the codes may differ. `scratch` is
/// recycled. Cost: one pass for every 11 bits.
void sortByMortonCode(std::vector<MortonCoded>& coded, std::vector<MortonCoded>& scratch, int bits);

}  // namespace saccade
