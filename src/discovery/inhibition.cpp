#include "saccade/discovery/inhibition.hpp"

#include <utility>

#include "discovery/white_pixels.hpp"

namespace saccade {

InhibitionSplit withoutInhibited(Candidates pool, const Perception& seen, const cv::Mat1b& ior,
                                 const InhibitionConfig& config) {
  InhibitionSplit split;
  split.open = std::move(pool);
  if (ior.empty()) return split;
  const WhitePixels inhibited(ior, seen, "withoutInhibited: the 2D IOR map");
  std::size_t open = 0;
  for (Candidate& candidate : split.open) {
    candidate.inhibited_share = inhibited.shareOf(candidate);
    candidate.inhibited =
        config.enabled && candidate.inhibited_share > 0.0 && candidate.inhibited_share >= config.theta;
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

void noteFamiliar(Candidates& candidates, const Perception& seen, const cv::Mat1b& familiar) {
  if (familiar.empty()) return;
  const WhitePixels pixels(familiar, seen, "noteFamiliar: the image of familiar leaves");
  for (Candidate& candidate : candidates) candidate.familiar_share = pixels.shareOf(candidate);
}

}  // namespace saccade
