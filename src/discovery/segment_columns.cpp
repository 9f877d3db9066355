#include "saccade/discovery/segment_columns.hpp"

#include <algorithm>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

/// Adds to each column whether its label changes from one row to the next.
SACCADE_MULTIVERSION void countChanges(const int* above, const int* below, int width, std::int32_t* changes) {
  for (int u = 0; u < width; ++u) changes[u] += above[u] != below[u] ? 1 : 0;
}

}  // namespace

void SegmentColumns::build(const Segmentation& segmentation) {
  const cv::Mat1i& labels = segmentation.labels;
  makeRoom(labels);
  std::fill(top_.begin(), top_.end(), 0);
  const auto close = [&](int u, std::int32_t label, int end_v) {
    const auto c = static_cast<std::size_t>(u);
    if (label >= 0) runs_[ends_[c]++] = {label, top_[c], end_v};
    top_[c] = end_v;
  };
  for (int v = 1; v < labels.rows; ++v) {
    const int *above = labels[v - 1], *below = labels[v];
    for (int u = 0; u < labels.cols; ++u) {
      if (above[u] != below[u]) close(u, above[u], v);
    }
  }
  for (int u = 0; labels.rows > 0 && u < labels.cols; ++u) close(u, labels(labels.rows - 1, u), labels.rows);
  boundSegments(labels.cols, segmentation.count);
}

/// Gives each column as much room as it has changes of label.
void SegmentColumns::makeRoom(const cv::Mat1i& labels) {
  const auto width = static_cast<std::size_t>(labels.cols);
  changes_.assign(width, 1);
  for (int v = 1; v < labels.rows; ++v) countChanges(labels[v - 1], labels[v], labels.cols, changes_.data());
  begins_.resize(width);
  top_.resize(width);
  std::size_t total = 0;
  for (std::size_t u = 0; u < width; ++u) {
    begins_[u] = total;
    total += static_cast<std::size_t>(changes_[u]);
  }
  ends_ = begins_;
  if (runs_.size() < total) runs_.resize(total);
}

void SegmentColumns::boundSegments(int width, int count) {
  boxes_.assign(static_cast<std::size_t>(count), cv::Rect());
  for (int u = 0; u < width; ++u) {
    for (const Run& run : column(u)) {
      cv::Rect& box = boxes_[static_cast<std::size_t>(run.segment)];
      if (box.width == 0) box = {u, run.begin_v, 0, run.end_v - run.begin_v};
      const int top = std::min(box.y, run.begin_v), bottom = std::max(box.y + box.height, run.end_v);
      box = {box.x, top, u + 1 - box.x, bottom - top};
    }
  }
}

}  // namespace saccade
