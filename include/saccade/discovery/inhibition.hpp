#pragma once

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

struct InhibitionConfig {
  bool enabled = true;
  double theta = 0.3;

  void describe(ConfigVisitor& v) {
    v.flag("enabled", enabled, "candidates that were attended long enough are kept from the ranking");
    v.number("theta", theta, {0.0, 1.0}, "", "share of a candidate that must be white in the 2D IOR map to inhibit it");
  }
};

/// The pool, split by the 2D IOR map. Both parts keep the pool's order.
struct InhibitionSplit {
  Candidates open;
  Candidates inhibited;
};

/// Splits `pool` by the 2D IOR map (paper, "Inhibition of object candidates"), before any ranking: a candidate is
/// inhibited if the share of its pixels that are not 0 in `ior` is at least θ. Sets inhibited_share and inhibited.
///
/// `ior` has the image's size (std::invalid_argument otherwise); an empty one inhibits nothing. Not `enabled`: the
/// shares are set, nothing is inhibited. One pass over the image, then O(segments) a candidate.
[[nodiscard]] InhibitionSplit withoutInhibited(Candidates pool, const Perception& seen, const cv::Mat1b& ior,
                                               const InhibitionConfig& config = {});

/// Notes how familiar each candidate is: sets familiar_share, the share of its pixels that are not 0 in `familiar`
/// (IorView::familiar), which ranks new things first (RankingConfig::familiar_loss).
///
/// `familiar` has the image's size (std::invalid_argument otherwise); an empty one leaves all as they are. One pass
/// over the image, then O(segments) a candidate.
void noteFamiliar(Candidates& candidates, const Perception& seen, const cv::Mat1b& familiar);

}  // namespace saccade
