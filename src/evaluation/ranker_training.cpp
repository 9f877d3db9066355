#include "saccade/evaluation/ranker_training.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "labelled_pool.hpp"

namespace saccade {
namespace {

constexpr double kRoundTo = 1000.0;  // scaled values are rounded to 1 / 1000 so that the model's text is short

struct Example {
  const Candidate* candidate = nullptr;
  std::int8_t label = 0;
  int group = 0;
};

std::vector<Example> chooseExamples(const std::vector<LabelledPool>& pools, const RankerTrainingConfig& config) {
  std::mt19937_64 random(static_cast<std::uint64_t>(config.seed));
  std::vector<Example> examples;
  for (std::size_t frame = 0; frame < pools.size(); ++frame) {
    const LabelledPool& pool = pools[frame];
    for (const Kind kind : {Kind::kObject, Kind::kOther}) {
      std::vector<std::size_t> all;
      for (std::size_t i = 0; i < pool.kinds.size(); ++i) {
        if (pool.kinds[i] == kind) all.push_back(i);
      }
      for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random() % i]);
      const int limit = kind == Kind::kObject ? config.positives_per_frame : config.negatives_per_frame;
      all.resize(std::min(all.size(), static_cast<std::size_t>(limit)));
      std::sort(all.begin(), all.end());
      for (const std::size_t i : all) {
        const auto label = static_cast<std::int8_t>(kind == Kind::kObject ? 1 : -1);
        examples.push_back({&pool.candidates[i], label, static_cast<int>(frame)});
      }
    }
  }
  return examples;
}

Judge trainJudge(const std::vector<Example>& examples, FeatureSet set, bool with_depth, SvmTrainingConfig svm_config) {
  SvmExamples svm;
  svm.dimension = featureCount(set, with_depth);
  for (const Example& example : examples) {
    if (with_depth && !example.candidate->has_depth) continue;
    appendFeatures(*example.candidate, set, with_depth, svm.rows);
    svm.labels.push_back(example.label);
    svm.groups.push_back(example.group);
  }
  Judge judge;
  const auto n = static_cast<double>(std::max<std::size_t>(1, svm.size()));
  for (std::size_t column = 0; column < svm.dimension; ++column) {
    double sum = 0.0, squared = 0.0;
    for (std::size_t i = column; i < svm.rows.size(); i += svm.dimension) {
      sum += static_cast<double>(svm.rows[i]);
      squared += static_cast<double>(svm.rows[i]) * static_cast<double>(svm.rows[i]);
    }
    const double mean = sum / n, deviation = std::sqrt(std::max(0.0, squared / n - mean * mean));
    judge.mean.push_back(static_cast<float>(mean));
    judge.scale.push_back(deviation > 1e-9 ? static_cast<float>(deviation) : 1.0F);
  }
  judge.scaleRows(svm.rows);
  for (float& value : svm.rows)
    value = static_cast<float>(std::round(static_cast<double>(value) * kRoundTo) / kRoundTo);
  judge.svm = trainSvm(svm, svm_config);
  return judge;
}

RankerModel trainModel(const std::vector<Example>& examples, FeatureSet set, const SvmTrainingConfig& svm_config) {
  Judge with_depth = trainJudge(examples, set, true, svm_config);
  return {set, std::move(with_depth), trainJudge(examples, set, false, svm_config)};
}

// The pool's candidates with their number in place of their segments, which are not needed any more.
Candidates lightCopies(const LabelledPool& pool) {
  Candidates copies;
  for (std::size_t i = 0; i < pool.candidates.size(); ++i) {
    Candidate copy = pool.candidates[i];
    copy.segments.assign(1, static_cast<std::int32_t>(i));
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

RankerTrial crossValidate(const std::vector<LabelledPool>& pools, FeatureSet set, const RankerTrainingConfig& config,
                          const SvmTrainingConfig& svm_config) {
  const std::vector<Example> examples = chooseExamples(pools, config);
  DiscoveryScore score;
  RocArea roc;
  for (int fold = 0; fold < config.folds; ++fold) {
    std::vector<Example> rest;
    for (const Example& example : examples) {
      if (pools[static_cast<std::size_t>(example.group)].fold != fold) rest.push_back(example);
    }
    const RankerModel model = trainModel(rest, set, svm_config);
    for (const LabelledPool& pool : pools) {
      if (pool.fold != fold) continue;
      Candidates scored = lightCopies(pool);
      model.score(scored);
      roc.add(pool, scored);
      score.add(rankHeldOut(pool, std::move(scored), config.discovery.ranking));
    }
  }
  return {svm_config.c, svm_config.gamma, roc.value(), score.recall(5), score.recall(10), score.recall(20)};
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

std::vector<FeatureValue> ablate(const std::vector<LabelledPool>& pools, FeatureSet set,
                                 const RankerTrainingConfig& config, const SvmTrainingConfig& svm_config,
                                 const RankerTrial& whole) {
  std::vector<FeatureValue> values;
  const std::vector<std::string_view> names = featureNames(set);
  for (std::size_t feature = 0; feature < names.size(); ++feature) {
    const RankerTrial trial = crossValidate(withoutFeature(pools, feature), set, config, svm_config);
    values.push_back({names[feature], whole.auc - trial.auc, whole.merit() - trial.merit()});
  }
  return values;
}

}  // namespace

RankerTraining trainRanker(const std::vector<std::string>& inputs, const RankerTrainingConfig& config) {
  requireValid(config);
  const std::vector<LabelledPool> pools = readLabelledPools(inputs, config);
  const std::vector<Example> examples = chooseExamples(pools, config);

  RankerTraining result;
  result.frames = static_cast<int>(pools.size());
  for (const Example& example : examples) ++(example.label > 0 ? result.positives : result.negatives);
  if (result.positives == 0 || result.negatives == 0) {
    throw std::invalid_argument("trainRanker: " + std::to_string(result.positives) + " candidates show objects and " +
                                std::to_string(result.negatives) + " do not, in " + std::to_string(result.frames) +
                                " labelled frames with depth; both are needed");
  }
  const FeatureSet set = config.discovery.ranking.paper ? FeatureSet::kPaper : FeatureSet::kExtended;
  SvmTrainingConfig svm;
  svm.max_vectors = config.max_vectors;
  svm.seed = static_cast<std::uint64_t>(config.seed);
  for (const double c : config.c_values) {
    for (const double gamma : config.gamma_values) {
      svm.c = c;
      svm.gamma = gamma;
      result.trials.push_back(crossValidate(pools, set, config, svm));
      if (result.trials.size() == 1 || result.trials.back().merit() > result.chosen.merit()) {
        result.chosen = result.trials.back();
      }
    }
  }
  svm.c = result.chosen.c;
  svm.gamma = result.chosen.gamma;
  if (config.ablation) result.ablation = ablate(pools, set, config, svm, result.chosen);
  result.model = trainModel(examples, set, svm);
  return result;
}

}  // namespace saccade
