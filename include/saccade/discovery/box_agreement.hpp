#pragma once

#include <vector>

#include "saccade/discovery/candidate.hpp"

namespace saccade {

/// Returns for each candidate how many unions of the pool have nearly its box, its own included (what Candidate::unions
/// says of each, summed):
/// intersection over union at least 0.7. Beyond the paper: an object's box is met again on many ways through the
/// segments, by colour and by depth, that of an accidental union is not.
///
/// Exact, in whole numbers; images up to 100 megapixels. About 0.3 ms for 1 500 candidates.
[[nodiscard]] std::vector<int> countAgreeing(const Candidates& candidates);

}  // namespace saccade
