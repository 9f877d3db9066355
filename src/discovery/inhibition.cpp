#include "saccade/discovery/inhibition.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace saccade {
namespace {

std::vector<int> inhibitedPixels(const Segmentation& segmentation, const cv::Mat1b& ior) {
  std::vector<int> pixels(static_cast<std::size_t>(segmentation.count), 0);
  if (segmentation.count == 0) return pixels;
  for (int v = 0; v < ior.rows; ++v) {
    const std::uint8_t* white = ior[v];
    const int* labels = segmentation.labels[v];
    for (int u = 0; u < ior.cols; ++u) {
      if (white[u] != 0 && labels[u] >= 0) ++pixels[static_cast<std::size_t>(labels[u])];
    }
  }
  return pixels;
}

}  // namespace

InhibitionSplit withoutInhibited(Candidates pool, const Perception& seen, const cv::Mat1b& ior,
                                 const InhibitionConfig& config) {
  InhibitionSplit split;
  if (ior.empty()) {
    split.open = std::move(pool);
    return split;
  }
  if (ior.size() != seen.imageSize()) {
    throw std::invalid_argument("withoutInhibited: the 2D IOR map has " + std::to_string(ior.cols) + "x" +
                                std::to_string(ior.rows) + " pixels, the frame " +
                                std::to_string(seen.imageSize().width) + "x" + std::to_string(seen.imageSize().height));
  }
  const std::vector<int> color = inhibitedPixels(seen.color, ior), surface = inhibitedPixels(seen.surface, ior);
  for (Candidate& candidate : pool) {
    const std::vector<int>& pixels = candidate.source == CandidateSource::kColor ? color : surface;
    int white = 0;
    for (const std::int32_t segment : candidate.segments) white += pixels[static_cast<std::size_t>(segment)];
    candidate.inhibited_share = candidate.area > 0 ? static_cast<double>(white) / candidate.area : 0.0;
    candidate.inhibited = config.enabled && white > 0 && candidate.inhibited_share >= config.theta;
    (candidate.inhibited ? split.inhibited : split.open).push_back(std::move(candidate));
  }
  return split;
}

}  // namespace saccade
