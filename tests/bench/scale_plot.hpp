#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace saccade::bench {

/// What one stage costs on maps of some sizes.
struct ScaleLine {
  std::string stage;
  std::vector<double> leaves, time_ms;  ///< by rising size
};

/// Writes an SVG of cost per frame over the number of leaves, which runs logarithmically. Throws std::runtime_error if
/// it cannot be written.
void writeScalePlot(const std::filesystem::path& path, const std::vector<ScaleLine>& lines);

}  // namespace saccade::bench
