#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saccade/core/frame.hpp"

namespace saccade {

/// How depth must be changed to show the same things as colour. Gains are of the contrast that colour has where depth
/// has an edge, over the same without the change: 1 is none.
struct EdgeAgreement {
  std::string best_turn = "as it is";  ///< or "turned by 180 degrees", "mirrored", "upside down"
  double gain_of_turn = 1.0;
  int best_lag = 0;  ///< frames by which depth comes too late (too early if negative)
  double gain_of_lag = 1.0;
};

/// Compares the edges of colour and depth, of the same frame and of frames some time apart, as they are and turned.
/// None where depth has too few edges.
[[nodiscard]] std::optional<EdgeAgreement> compareEdges(const std::vector<RgbdFrame>& frames);

}  // namespace saccade
