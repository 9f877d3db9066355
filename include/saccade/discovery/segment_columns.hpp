#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// Some segments of an image column by column, as runs of one segment: some twenty a column where there are hundreds of
/// pixels, so that the outline of a union of segments is written without touching pixels. Recycles its buffers.
class SegmentColumns {
 public:
  struct Run {
    std::int32_t segment;
    std::int32_t begin_v, end_v;
  };

  /// Begins an image of `width` columns; of its segments those are kept whose entry in `wanted` is not 0.
  void begin(int width, std::span<const char> wanted);
  /// Adds the next row, from the top: the segment of each pixel, or -1. One pass over the labels, of which most are as
  /// those above them.
  void addRow(const std::int32_t* labels);
  /// Ends the image after its last row.
  void end();

  [[nodiscard]] int segmentCount() const { return static_cast<int>(boxes_.size()); }
  /// The runs of a column from the top.
  [[nodiscard]] std::span<const Run> column(int u) const {
    const auto c = static_cast<std::size_t>(u);
    return {runs_.data() + begins_[c], runs_.data() + begins_[c + 1]};
  }
  /// Box of a segment; empty if it has no pixel or was not wanted.
  [[nodiscard]] const cv::Rect& box(std::int32_t segment) const { return boxes_[static_cast<std::size_t>(segment)]; }

 private:
  struct ColumnRun {
    std::int32_t u;
    Run run;
  };

  void close(int u);
  void sortByColumn();
  void boundSegments();

  int width_ = 0, rows_ = 0;
  std::vector<char> wanted_;           ///< by segment
  std::vector<std::int32_t> above_;    ///< labels of the last row
  std::vector<std::int32_t> changed_;  ///< columns where a row differs from the one above
  std::vector<std::int32_t> top_;      ///< by column: first row of the run that is being read
  std::vector<ColumnRun> found_;       ///< by rows of their ends
  std::vector<Run> runs_;              ///< by columns
  std::vector<std::size_t> begins_;    ///< of the columns' runs, and the end
  std::vector<cv::Rect> boxes_;        ///< by segment
};

}  // namespace saccade
