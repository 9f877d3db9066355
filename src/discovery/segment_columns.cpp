#include "saccade/discovery/segment_columns.hpp"

#include <algorithm>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

/// Pixels that are compared at once: most rows are as those above them.
constexpr int kGroup = 16;

/// Writes the columns at which two rows differ to `columns` and returns how many there are.
SACCADE_MULTIVERSION int differingColumns(const std::int32_t* above, const std::int32_t* below, int width,
                                          std::int32_t* columns) {
  int count = 0;
  const auto compare = [&](int begin, int end) {
    for (int u = begin; u < end; ++u) {
      if (above[u] != below[u]) columns[count++] = u;
    }
  };
  int u = 0;
  for (; u + kGroup <= width; u += kGroup) {
    std::int32_t differs = 0;
    for (int i = 0; i < kGroup; ++i) differs |= above[u + i] ^ below[u + i];
    if (differs != 0) compare(u, u + kGroup);
  }
  compare(u, width);
  return count;
}

}  // namespace

void SegmentColumns::begin(int width, std::span<const char> wanted) {
  width_ = width;
  rows_ = 0;
  wanted_.assign(wanted.begin(), wanted.end());
  const auto columns = static_cast<std::size_t>(width);
  above_.assign(columns, -1);
  changed_.resize(columns);
  top_.assign(columns, 0);
  found_.clear();
}

void SegmentColumns::addRow(const std::int32_t* labels) {
  const int changes = differingColumns(above_.data(), labels, width_, changed_.data());
  for (int i = 0; i < changes; ++i) {
    const int u = changed_[static_cast<std::size_t>(i)];
    close(u);
    above_[static_cast<std::size_t>(u)] = labels[u];
  }
  ++rows_;
}

/// Ends the run that the last row has in column `u`.
void SegmentColumns::close(int u) {
  const auto c = static_cast<std::size_t>(u);
  const std::int32_t label = above_[c];
  if (label >= 0 && wanted_[static_cast<std::size_t>(label)] != 0) found_.push_back({u, {label, top_[c], rows_}});
  top_[c] = rows_;
}

void SegmentColumns::end() {
  for (int u = 0; u < width_; ++u) close(u);
  sortByColumn();
  boundSegments();
}

void SegmentColumns::sortByColumn() {
  begins_.assign(static_cast<std::size_t>(width_) + 2, 0);
  for (const ColumnRun& found : found_) ++begins_[static_cast<std::size_t>(found.u) + 2];
  for (std::size_t c = 2; c < begins_.size(); ++c) begins_[c] += begins_[c - 1];
  runs_.resize(found_.size());
  // Placing them moves the begin of each column, one entry on, to its end: the begin of the next.
  for (const ColumnRun& found : found_) runs_[begins_[static_cast<std::size_t>(found.u) + 1]++] = found.run;
}

void SegmentColumns::boundSegments() {
  boxes_.assign(wanted_.size(), cv::Rect());
  for (int u = 0; u < width_; ++u) {
    for (const Run& run : column(u)) {
      cv::Rect& box = boxes_[static_cast<std::size_t>(run.segment)];
      if (box.width == 0) box = {u, run.begin_v, 0, run.end_v - run.begin_v};
      const int top = std::min(box.y, run.begin_v), bottom = std::max(box.y + box.height, run.end_v);
      box = {box.x, top, u + 1 - box.x, bottom - top};
    }
  }
}

}  // namespace saccade
