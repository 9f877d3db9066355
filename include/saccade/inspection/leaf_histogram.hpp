#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "saccade/map/map_cursor.hpp"

namespace saccade {

/// What of the occupied leaves a histogram counts.
enum class LeafQuantity {
  kIorWeight,     ///< ticks until attention forgets the leaf; leaves that it has forgotten are counted apart
  kOccupancy,     ///< probability
  kObservations,  ///< frames that hit the leaf; leaves without a count are counted apart
};

/// The quantity called "weight", "occupancy" or "observations". Throws std::invalid_argument that lists them for any
/// other name.
[[nodiscard]] LeafQuantity leafQuantity(std::string_view name);
/// The names that leafQuantity() knows.
[[nodiscard]] const std::vector<std::string>& leafQuantityNames();

/// Counts of leaves, a coarse one counted once. Bin i holds values from `lowest + i * step` to less than
/// `lowest + (i + 1) * step`; the last one its upper end too.
struct LeafHistogram {
  double lowest = 0.0, step = 1.0;
  std::vector<std::int64_t> counts;  ///< empty where no leaf has a value
  std::int64_t without = 0;          ///< leaves whose value is 0: attention has forgotten them, or nothing was counted
  std::int64_t leaves = 0;           ///< all occupied ones
  double mean = 0.0;                 ///< of those with a value
};

/// Histogram over at most `bins` bins of equal width, whole ticks or frames wide. Cost: every occupied leaf.
/// Throws std::invalid_argument for less than one bin.
[[nodiscard]] LeafHistogram histogramOf(const MapTree& map, LeafQuantity quantity, int bins);

}  // namespace saccade
