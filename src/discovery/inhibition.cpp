#include "saccade/discovery/inhibition.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace saccade {
namespace {

/// White pixels of each segment: those of a run are the difference of two sums along the row.
std::vector<int> inhibitedPixels(const LabelRuns& runs, const cv::Mat1i& white_before) {
  std::vector<int> pixels(static_cast<std::size_t>(runs.segments()), 0);
  for (int v = 0; v < runs.rows(); ++v) {
    const int* before = white_before[v];
    if (before[white_before.cols - 1] == 0) continue;
    int begin = 0;
    for (const LabelRun& run : runs.row(v)) {
      if (run.label >= 0) pixels[static_cast<std::size_t>(run.label)] += before[run.end_u] - before[begin];
      begin = run.end_u;
    }
  }
  return pixels;
}

/// For each pixel, and the end of each row, how many white ones the row has before it.
cv::Mat1i whiteBefore(const cv::Mat1b& ior) {
  cv::Mat1i before(ior.rows, ior.cols + 1);
  for (int v = 0; v < ior.rows; ++v) {
    const std::uint8_t* white = ior[v];
    int* counts = before[v];
    int count = 0;
    for (int u = 0; u < ior.cols; ++u) {
      counts[u] = count;
      count += white[u] != 0 ? 1 : 0;
    }
    counts[ior.cols] = count;
  }
  return before;
}

}  // namespace

InhibitionSplit withoutInhibited(Candidates pool, const Perception& seen, const cv::Mat1b& ior,
                                 const InhibitionConfig& config) {
  InhibitionSplit split;
  split.open = std::move(pool);
  if (ior.empty()) return split;
  if (ior.size() != seen.imageSize()) {
    throw std::invalid_argument("withoutInhibited: the 2D IOR map has " + std::to_string(ior.cols) + "x" +
                                std::to_string(ior.rows) + " pixels, the frame " +
                                std::to_string(seen.imageSize().width) + "x" + std::to_string(seen.imageSize().height));
  }
  const cv::Mat1i white_before = whiteBefore(ior);
  const std::vector<int> color = inhibitedPixels(seen.color_segments.runs(), white_before),
                         surface = inhibitedPixels(seen.surface_segments.runs(), white_before);
  std::size_t open = 0;
  for (Candidate& candidate : split.open) {
    const std::vector<int>& pixels = candidate.source == CandidateSource::kColor ? color : surface;
    int white = 0;
    for (const std::int32_t segment : candidate.segments) white += pixels[static_cast<std::size_t>(segment)];
    candidate.inhibited_share = candidate.area > 0 ? static_cast<double>(white) / candidate.area : 0.0;
    candidate.inhibited = config.enabled && white > 0 && candidate.inhibited_share >= config.theta;
    if (candidate.inhibited) {
      split.inhibited.push_back(std::move(candidate));
    } else {
      if (&candidate != &split.open[open]) split.open[open] = std::move(candidate);
      ++open;
    }
  }
  split.open.resize(open);
  return split;
}

}  // namespace saccade
