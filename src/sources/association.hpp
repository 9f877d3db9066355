#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace saccade {

using StampPair = std::pair<std::size_t, std::size_t>;  ///< indices into the first and the second list

/// Pairs two rising lists of stamps one to one: always the closest pair that is left, as long as its stamps differ by
/// no more than `max_difference_s`. Sorted by the first index. Cost n log n for stamps no denser than the window.
[[nodiscard]] std::vector<StampPair> associate(const std::vector<double>& first_s, const std::vector<double>& second_s,
                                               double max_difference_s);

}  // namespace saccade
