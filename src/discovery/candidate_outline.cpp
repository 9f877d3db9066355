#include "saccade/discovery/candidate_outline.hpp"

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/coco_rle.hpp"

namespace saccade {

void CandidateOutliner::begin(const FrameSegments& seen) {
  take(seen.color, color_);
  if (seen.surface.count > 0) take(seen.surface, surface_);
}

void CandidateOutliner::take(const Segmentation& ideal, SegmentColumns& columns) {
  if (pixels_.areIdeal()) {
    columns.build(ideal);
    return;
  }
  distorted_.count = ideal.count;
  pixels_.distort(ideal.labels, distorted_.labels, -1);
  columns.build(distorted_);
}

CandidateOutline CandidateOutliner::outline(const Candidate& candidate) const {
  const SegmentColumns& columns = candidate.source == CandidateSource::kColor ? color_ : surface_;
  CandidateOutline outline;
  for (const std::int32_t segment : candidate.segments) outline.box |= columns.box(segment);
  const SegmentMembership members(candidate, columns.segmentCount());
  CocoRleWriter writer(pixels_.size());
  for (int u = outline.box.x; u < outline.box.x + outline.box.width; ++u) {
    for (const SegmentColumns::Run& run : columns.column(u)) {
      if (members.contains(run.segment)) writer.addRun(u, run.begin_v, run.end_v);
    }
  }
  outline.mask = writer.finish();
  return outline;
}

}  // namespace saccade
