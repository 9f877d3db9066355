#include "saccade/evaluation/ranker_training.hpp"

#include <algorithm>
#include <stdexcept>

#include "labelled_pool.hpp"
#include "ranker_learners.hpp"

namespace saccade {
namespace {

// The pool's candidates with their number in place of their segments, which are not needed any more.
Candidates lightCopies(const LabelledPool& pool) {
  Candidates copies;
  for (std::size_t i = 0; i < pool.candidates.size(); ++i) {
    Candidate copy = pool.candidates[i];
    copy.segments = {static_cast<std::int32_t>(i)};
    copies.push_back(std::move(copy));
  }
  return copies;
}

// Matches of a held-out frame's scored light copies, without the merging of duplicates, which needs masks.
FrameMatches rankHeldOut(const LabelledPool& pool, Candidates ranked, const RankingConfig& ranking) {
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  if (!ranking.paper && ranking.suppress) suppressOverlapping(ranked, ranking);
  FrameMatches matches;
  matches.object_ids = pool.object_ids;
  matches.found_at.assign(pool.object_ids.size(), FrameMatches::kNever);
  for (std::size_t rank = 0; rank < ranked.size(); ++rank) {
    for (const int object : pool.shows[static_cast<std::size_t>(ranked[rank].segments[0])]) {
      int& found = matches.found_at[static_cast<std::size_t>(object)];
      if (found == FrameMatches::kNever) found = static_cast<int>(rank);
    }
  }
  return matches;
}

// Area under the ROC curve: how often a candidate that shows an object has a higher score than one that does not.
class RocArea {
 public:
  void add(const LabelledPool& pool, const Candidates& scored) {
    for (std::size_t i = 0; i < scored.size(); ++i) {
      if (pool.kinds[i] != Kind::kUndecided) scores_.emplace_back(scored[i].score, pool.kinds[i] == Kind::kObject);
    }
  }
  // By the sum of ranks (Mann & Whitney); equal scores share their ranks.
  [[nodiscard]] double value() {
    std::sort(scores_.begin(), scores_.end());
    double rank_sum = 0.0, objects = 0.0;
    for (std::size_t begin = 0, end = 0; begin < scores_.size(); begin = end) {
      while (end < scores_.size() && scores_[end].first == scores_[begin].first) ++end;
      const double rank = 0.5 * static_cast<double>(begin + 1 + end);
      for (std::size_t i = begin; i < end; ++i) {
        if (!scores_[i].second) continue;
        rank_sum += rank;
        objects += 1.0;
      }
    }
    const double others = static_cast<double>(scores_.size()) - objects;
    return objects > 0.0 && others > 0.0 ? (rank_sum - objects * (objects + 1.0) / 2.0) / (objects * others) : 0.0;
  }

 private:
  std::vector<std::pair<double, bool>> scores_;
};

RankerTrial crossValidate(const std::vector<LabelledPool>& pools, const RankerTrainingConfig& config,
                          const RankerLearner& learner) {
  DiscoveryScore score;
  RocArea roc;
  for (int fold = 0; fold < config.folds; ++fold) {
    std::vector<const LabelledPool*> rest;
    for (const LabelledPool& pool : pools) {
      if (pool.fold != fold) rest.push_back(&pool);
    }
    const RankerModel model = learner.train(rest);
    for (const LabelledPool& pool : pools) {
      if (pool.fold != fold) continue;
      Candidates scored = lightCopies(pool);
      model.score(scored);
      roc.add(pool, scored);
      score.add(rankHeldOut(pool, std::move(scored), config.discovery.ranking));
    }
  }
  return {learner.settings, roc.value(), score.recall(5), score.recall(10), score.recall(20)};
}

// A feature that is the same everywhere tells nothing: that is how it is taken away.
std::vector<LabelledPool> withoutFeature(std::vector<LabelledPool> pools, std::size_t feature) {
  for (LabelledPool& pool : pools) {
    for (Candidate& candidate : pool.candidates) {
      (feature < kFeatureCount ? candidate.features[feature] : candidate.cues[feature - kFeatureCount]) = 0.0F;
    }
  }
  return pools;
}

std::vector<FeatureValue> ablate(const std::vector<LabelledPool>& pools, const RankerTrainingConfig& config,
                                 const RankerLearner& learner, const RankerTrial& whole) {
  std::vector<FeatureValue> values;
  const bool is_paper = config.discovery.ranking.paper;
  const std::vector<std::string_view> names = featureNames(is_paper ? FeatureSet::kPaper : FeatureSet::kExtended);
  for (std::size_t feature = 0; feature < names.size(); ++feature) {
    const RankerTrial trial = crossValidate(withoutFeature(pools, feature), config, learner);
    values.push_back({names[feature], whole.auc - trial.auc, whole.merit() - trial.merit()});
  }
  return values;
}

}  // namespace

RankerTraining trainRanker(const std::vector<std::string>& inputs, const RankerTrainingConfig& config) {
  requireValid(config);
  const std::vector<LabelledPool> pools = readLabelledPools(inputs, config);

  RankerTraining result;
  result.frames = static_cast<int>(pools.size());
  std::vector<const LabelledPool*> all;
  for (const LabelledPool& pool : pools) {
    all.push_back(&pool);
    result.objects += static_cast<int>(std::count(pool.kinds.begin(), pool.kinds.end(), Kind::kObject));
    result.others += static_cast<int>(std::count(pool.kinds.begin(), pool.kinds.end(), Kind::kOther));
  }
  if (result.objects == 0 || result.others == 0) {
    throw std::invalid_argument("trainRanker: " + std::to_string(result.objects) + " candidates show objects and " +
                                std::to_string(result.others) + " do not, in " + std::to_string(result.frames) +
                                " labelled frames with depth; both are needed");
  }
  const std::vector<RankerLearner> learners = rankerLearners(config);
  const RankerLearner* best = &learners.front();
  for (const RankerLearner& learner : learners) {
    result.trials.push_back(crossValidate(pools, config, learner));
    if (result.trials.size() == 1 || result.trials.back().merit() > result.chosen.merit()) {
      result.chosen = result.trials.back();
      best = &learner;
    }
  }
  if (config.ablation) result.ablation = ablate(pools, config, *best, result.chosen);
  result.model = best->train(all);
  return result;
}

}  // namespace saccade
