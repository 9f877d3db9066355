#pragma once

#include "saccade/core/config_fields.hpp"
#include "saccade/discovery/inhibition.hpp"
#include "saccade/discovery/perceiver.hpp"
#include "saccade/discovery/proposals.hpp"
#include "saccade/discovery/ranker.hpp"

namespace saccade {

/// Settings of the whole way from a frame to its ranked candidates.
struct DiscoveryConfig {
  PerceptionConfig perception;
  ProposalConfig proposal;
  InhibitionConfig inhibition;
  RankingConfig ranking;

  void describe(ConfigVisitor& v) {
    v.section("perception", perception, "saliency, blobs and segments");
    v.section("proposal", proposal, "candidates from blobs and segments");
    v.section("inhibition", inhibition, "inhibition of return");
    v.section("ranking", ranking, "features, SVM and order");
  }

  /// Switches off everything in this stage that goes beyond the paper.
  void usePaperOnly() {
    perception.max_maxima = 0;
    perception.color = {};
    perception.surface = {};
    proposal.paper = true;
    ranking.paper = true;
  }
};

}  // namespace saccade
