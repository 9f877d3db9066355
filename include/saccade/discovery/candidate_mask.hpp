#pragma once

#include <opencv2/core.hpp>

#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

/// Writes the mask of `candidate` into `mask`: the image's size, 255 inside, 0 outside. Reuses the buffer.
void drawMask(const Candidate& candidate, const Perception& seen, cv::Mat1b& mask);

/// Calls `visit(v, begin_u, end_u)` for each run of the mask's pixels in a row, rows from the top, runs from the left.
/// Touches the pixels of the candidate's box only.
template <typename Visit>
void forEachMaskRun(const Candidate& candidate, const FrameSegments& seen, Visit&& visit);

/// Answers "is this segment part of the candidate" in constant time.
class SegmentMembership {
 public:
  SegmentMembership(const Candidate& candidate, int segment_count)
      : member_(static_cast<std::size_t>(segment_count), 0) {
    for (const std::int32_t segment : candidate.segments) member_[static_cast<std::size_t>(segment)] = 1;
  }
  [[nodiscard]] bool contains(std::int32_t label) const {
    return label >= 0 && member_[static_cast<std::size_t>(label)] != 0;
  }

 private:
  std::vector<std::uint8_t> member_;
};

template <typename Visit>
void forEachMaskRun(const Candidate& candidate, const FrameSegments& seen, Visit&& visit) {
  const Segmentation& segmentation = seen.segmentation(candidate.source);
  const SegmentMembership members(candidate, segmentation.count);
  const int end = candidate.box.x + candidate.box.width;
  for (int v = candidate.box.y; v < candidate.box.y + candidate.box.height; ++v) {
    const int* labels = segmentation.labels[v];
    for (int u = candidate.box.x; u < end; ++u) {
      if (!members.contains(labels[u])) continue;
      const int begin = u;
      while (u < end && members.contains(labels[u])) ++u;
      visit(v, begin, u);
    }
  }
}

}  // namespace saccade
