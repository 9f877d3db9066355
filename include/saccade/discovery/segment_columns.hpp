#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

/// A segmentation column by column, as runs of one segment: some twenty a column where there are hundreds of pixels, so
/// that the outline of a union of segments is written without touching pixels. build() recycles its buffers.
class SegmentColumns {
 public:
  struct Run {
    std::int32_t segment;
    std::int32_t begin_v, end_v;
  };

  /// Takes the segments' runs; pixels in no segment are in none. Cost: two passes over the labels, 0.3 ms for 640×480.
  void build(const Segmentation& segmentation);

  [[nodiscard]] int segmentCount() const { return static_cast<int>(boxes_.size()); }
  /// The runs of a column from the top.
  [[nodiscard]] std::span<const Run> column(int u) const {
    const auto c = static_cast<std::size_t>(u);
    return {runs_.data() + begins_[c], runs_.data() + ends_[c]};
  }
  /// Box of a segment; empty if it has no pixel.
  [[nodiscard]] const cv::Rect& box(std::int32_t segment) const { return boxes_[static_cast<std::size_t>(segment)]; }

 private:
  void makeRoom(const cv::Mat1i& labels);
  void boundSegments(int width, int count);

  std::vector<Run> runs_;
  std::vector<std::size_t> begins_, ends_;  ///< of the columns' runs
  std::vector<std::int32_t> changes_;       ///< by column
  std::vector<std::int32_t> top_;           ///< by column: first row of the run that is being read
  std::vector<cv::Rect> boxes_;             ///< by segment
};

}  // namespace saccade
