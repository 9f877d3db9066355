#pragma once

#include <string>
#include <vector>

#include "saccade/preflight/preflight.hpp"

namespace saccade {

/// Statistics of rising stamps.
[[nodiscard]] StampStatistics stampStatistics(const std::vector<double>& stamps_s);

/// What is odd about the stamps of one stream, which `what` names ("colour"): duplicates and gaps.
void checkStamps(const StampStatistics& stamps, const std::string& what, std::vector<PreflightFinding>& findings);

/// What is odd about the stamps of colour and depth against each other: one shifted, one faster, many without partner.
void checkStampPairs(const std::vector<double>& color_s, const std::vector<double>& depth_s,
                     std::vector<PreflightFinding>& findings);

}  // namespace saccade
