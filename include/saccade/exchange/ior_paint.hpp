#pragma once

#include <array>
#include <cstdint>

#include "saccade/map/ior_law.hpp"
#include "saccade/map/leaf_surface.hpp"

namespace saccade {

/// How leaves are coloured in formats that know colour but no attention.
enum class LeafPaint {
  kColor,  ///< as the camera saw them; white where no colour is known
  kIor,    ///< by attention memory, see paintLeaf()
};

using Rgb = std::array<std::uint8_t, 3>;

/// Colour of a leaf at `now`. With kIor: what attention has not touched stays dark grey, attended leaves turn blue with
/// their IOR weight, inhibited ones go from red to yellow with the time until they are forgotten.
[[nodiscard]] Rgb paintLeaf(IorState ior, const LeafSurface& surface, Tick now, LeafPaint paint);

}  // namespace saccade
