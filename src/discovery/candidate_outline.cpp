#include "saccade/discovery/candidate_outline.hpp"

#include <algorithm>

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/coco_rle.hpp"

namespace saccade {

void CandidateOutliner::begin(const Perception& seen) {
  seen_ = &seen;
  if (pixels_.areIdeal()) return;
  distort(seen.color, color_);
  if (seen.has_depth) distort(seen.surface, surface_);
}

void CandidateOutliner::distort(const Segmentation& ideal, Distorted& distorted) const {
  distorted.segmentation.count = ideal.count;
  pixels_.distort(ideal.labels, distorted.segmentation.labels, -1);
  distorted.boxes.assign(static_cast<std::size_t>(ideal.count), cv::Rect());
  const cv::Size size = pixels_.size();
  std::vector<cv::Vec4i> extents(static_cast<std::size_t>(ideal.count), cv::Vec4i(size.width, size.height, -1, -1));
  for (int v = 0; v < size.height; ++v) {
    const int* row = distorted.segmentation.labels[v];
    for (int u = 0; u < size.width; ++u) {
      if (row[u] < 0) continue;
      cv::Vec4i& extent = extents[static_cast<std::size_t>(row[u])];
      extent = {std::min(extent[0], u), std::min(extent[1], v), std::max(extent[2], u), std::max(extent[3], v)};
    }
  }
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const cv::Vec4i& e = extents[i];
    if (e[2] >= 0) distorted.boxes[i] = {e[0], e[1], e[2] - e[0] + 1, e[3] - e[1] + 1};
  }
}

CandidateOutline CandidateOutliner::outline(const Candidate& candidate) const {
  if (pixels_.areIdeal()) {
    return {candidate.box, encodeCocoRle(boxMask(candidate, *seen_), candidate.box.tl(), pixels_.size())};
  }
  const Distorted& shown = candidate.source == CandidateSource::kColor ? color_ : surface_;
  CandidateOutline outline;
  for (const std::int32_t segment : candidate.segments) {
    outline.box |= shown.boxes[static_cast<std::size_t>(segment)];
  }
  const SegmentMembership members(candidate, shown.segmentation.count);
  cv::Mat1b mask(outline.box.size(), std::uint8_t{0});
  for (int v = 0; v < mask.rows; ++v) {
    const int* labels = shown.segmentation.labels[outline.box.y + v] + outline.box.x;
    for (int u = 0; u < mask.cols; ++u) mask(v, u) = members.contains(labels[u]) ? 255 : 0;
  }
  outline.mask = encodeCocoRle(mask, outline.box.tl(), pixels_.size());
  return outline;
}

}  // namespace saccade
