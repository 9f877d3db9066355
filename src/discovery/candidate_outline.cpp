#include "saccade/discovery/candidate_outline.hpp"

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/coco_rle.hpp"

namespace saccade {

void CandidateOutliner::begin(const FrameSegments& seen, std::span<const Candidate> open,
                              std::span<const Candidate> inhibited) {
  wanted_color_.assign(static_cast<std::size_t>(seen.color.count), 0);
  wanted_surface_.assign(static_cast<std::size_t>(seen.surface.count), 0);
  want(open);
  want(inhibited);
  take(seen.color, wanted_color_, color_);
  if (seen.surface.count > 0) take(seen.surface, wanted_surface_, surface_);
}

void CandidateOutliner::want(std::span<const Candidate> candidates) {
  for (const Candidate& candidate : candidates) {
    std::vector<char>& wanted = candidate.source == CandidateSource::kColor ? wanted_color_ : wanted_surface_;
    for (const std::int32_t segment : candidate.segments) wanted[static_cast<std::size_t>(segment)] = 1;
  }
}

void CandidateOutliner::take(const Segmentation& ideal, std::span<const char> wanted, SegmentColumns& columns) {
  const cv::Size size = pixels_.size();
  row_.resize(static_cast<std::size_t>(size.width));
  columns.begin(size.width, wanted);
  for (int v = 0; v < size.height; ++v) {
    pixels_.distortRow(ideal.labels, v, row_.data(), -1);
    columns.addRow(row_.data());
  }
  columns.end();
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
