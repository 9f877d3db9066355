#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

/// Neighbouring pixels of a row with one label; they begin where the run before ends.
struct LabelRun {
  std::int32_t end_u = 0;  ///< one past the last
  std::int32_t label = 0;  ///< -1: in no segment
};

/// The runs of a segmentation, row by row: what goes through an image's segments meets a tenth as many runs as pixels.
///
/// build() recycles all buffers.
class LabelRuns {
 public:
  /// Throws std::invalid_argument if a label is not below the segmentation's count.
  void build(const Segmentation& segmentation);

  [[nodiscard]] int rows() const { return static_cast<int>(row_end_.size()); }
  [[nodiscard]] int segments() const { return segments_; }
  /// Runs of row `v` from the left; together they cover it.
  [[nodiscard]] std::span<const LabelRun> row(int v) const {
    const auto i = static_cast<std::size_t>(v);
    const std::size_t begin = i == 0 ? 0 : row_end_[i - 1];
    return {runs_.data() + begin, row_end_[i] - begin};
  }

 private:
  std::vector<LabelRun> runs_;
  std::vector<std::size_t> row_end_;
  int segments_ = 0;
};

/// Calls `visit(begin_u, end_u, a, b)` for each stretch of columns over which two rows of runs, of equal width, keep
/// their labels a and b.
template <typename Visit>
void forEachCommonRun(std::span<const LabelRun> first, std::span<const LabelRun> second, const Visit& visit) {
  std::int32_t begin = 0;
  for (std::size_t i = 0, j = 0; i < first.size() && j < second.size();) {
    const std::int32_t end = std::min(first[i].end_u, second[j].end_u);
    visit(begin, end, first[i].label, second[j].label);
    const bool ends_first = first[i].end_u == end, ends_second = second[j].end_u == end;
    i += ends_first ? 1U : 0U;
    j += ends_second ? 1U : 0U;
    begin = end;
  }
}

}  // namespace saccade
