#include "ranker_learners.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "saccade/discovery/boosted_trees_training.hpp"
#include "saccade/discovery/svm_training.hpp"

namespace saccade {
namespace {

using Pools = std::vector<const LabelledPool*>;

constexpr double kRoundTo = 1000.0;  // scaled values are rounded to 1 / 1000 so that the model's text is short

// At most `limit` of `all`, drawn by the seed alone, in their order.
void drawAtMost(std::size_t limit, std::uint64_t seed, std::vector<std::size_t>& all) {
  if (all.size() <= limit) return;
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < limit; ++i) std::swap(all[i], all[i + random() % (all.size() - i)]);
  all.resize(limit);
  std::sort(all.begin(), all.end());
}

struct SvmExample {
  const Candidate* candidate = nullptr;
  std::int8_t label = 0;
  int group = 0;
};

std::vector<SvmExample> chooseSvmExamples(const Pools& pools, const SvmLearnerConfig& config, int seed) {
  std::vector<SvmExample> examples;
  for (std::size_t frame = 0; frame < pools.size(); ++frame) {
    const LabelledPool& pool = *pools[frame];
    for (const Kind kind : {Kind::kObject, Kind::kOther}) {
      std::vector<std::size_t> chosen;
      for (std::size_t i = 0; i < pool.kinds.size(); ++i) {
        if (pool.kinds[i] == kind) chosen.push_back(i);
      }
      const int limit = kind == Kind::kObject ? config.positives_per_frame : config.negatives_per_frame;
      drawAtMost(static_cast<std::size_t>(limit), static_cast<std::uint64_t>(seed) + frame, chosen);
      for (const std::size_t i : chosen) {
        const auto label = static_cast<std::int8_t>(kind == Kind::kObject ? 1 : -1);
        examples.push_back({&pool.candidates[i], label, static_cast<int>(frame)});
      }
    }
  }
  return examples;
}

ScaledSvm trainScaledSvm(const std::vector<SvmExample>& examples, FeatureSet set, bool with_depth,
                         const SvmTrainingConfig& config) {
  SvmExamples svm;
  svm.dimension = featureCount(set, with_depth);
  for (const SvmExample& example : examples) {
    if (with_depth && !example.candidate->has_depth) continue;
    appendFeatures(*example.candidate, set, with_depth, svm.rows);
    svm.labels.push_back(example.label);
    svm.groups.push_back(example.group);
  }
  ScaledSvm judge;
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
  judge.svm = trainSvm(svm, config);
  return judge;
}

// What a candidate is worth: 0 up to one overlap of boxes, 1 from another on. Those that nearly show an object are no
// worse than that, which the Pascal criterion alone would not tell.
float gradedTarget(double overlap, const TreesLearnerConfig& config) {
  return static_cast<float>(
      std::clamp((overlap - config.no_object) / (config.whole_object - config.no_object), 0.0, 1.0));
}

// Every frame weighs the same, however many candidates it has; of an object's candidates each weighs the less the more
// there are, so that large things, of which there are many, do not decide alone.
std::vector<float> balancedWeights(const LabelledPool& pool, const std::vector<std::size_t>& chosen,
                                   const TreesLearnerConfig& config) {
  std::vector<int> candidates_of(pool.object_ids.size(), 0);
  for (const std::size_t i : chosen) {
    for (const int object : pool.shows[i]) ++candidates_of[static_cast<std::size_t>(object)];
  }
  std::vector<double> weights(chosen.size(), 1.0);
  double weight_of_objects = 0.0, objects = 0.0;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const std::vector<int>& shows = pool.shows[chosen[k]];
    if (shows.empty()) continue;
    const int fewest =
        candidates_of[static_cast<std::size_t>(*std::min_element(shows.begin(), shows.end(), [&](int a, int b) {
          return candidates_of[static_cast<std::size_t>(a)] < candidates_of[static_cast<std::size_t>(b)];
        }))];
    weights[k] = std::pow(fewest, -config.balance);
    weight_of_objects += weights[k];
    objects += 1.0;
  }
  const double frame = static_cast<double>(config.others_per_frame) / static_cast<double>(chosen.size());
  std::vector<float> result;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const bool shows_one = !pool.shows[chosen[k]].empty();
    result.push_back(static_cast<float>(frame * weights[k] * (shows_one ? objects / weight_of_objects : 1.0)));
  }
  return result;
}

BoostingExamples chooseTreeExamples(const Pools& pools, FeatureSet set, bool with_depth,
                                    const TreesLearnerConfig& config, int seed) {
  BoostingExamples examples;
  examples.dimension = featureCount(set, with_depth);
  for (std::size_t frame = 0; frame < pools.size(); ++frame) {
    const LabelledPool& pool = *pools[frame];
    std::vector<std::size_t> chosen, others;
    for (std::size_t i = 0; i < pool.candidates.size(); ++i) {
      if (with_depth && !pool.candidates[i].has_depth) continue;
      const bool is_object = gradedTarget(pool.overlaps[i], config) >= 0.5F;
      if (is_object || pool.is_trusted[i] != 0) (is_object ? chosen : others).push_back(i);
    }
    drawAtMost(static_cast<std::size_t>(config.others_per_frame), static_cast<std::uint64_t>(seed) + frame, others);
    chosen.insert(chosen.end(), others.begin(), others.end());
    for (const std::size_t i : chosen) {
      appendFeatures(pool.candidates[i], set, with_depth, examples.rows);
      examples.targets.push_back(gradedTarget(pool.overlaps[i], config));
    }
    const std::vector<float> weights = balancedWeights(pool, chosen, config);
    examples.weights.insert(examples.weights.end(), weights.begin(), weights.end());
  }
  return examples;
}

FeatureSet featureSet(const RankerTrainingConfig& config) {
  return config.discovery.ranking.paper ? FeatureSet::kPaper : FeatureSet::kExtended;
}

std::vector<RankerLearner> svmLearners(const RankerTrainingConfig& config) {
  std::vector<RankerLearner> learners;
  for (const double c : config.svm.c_values) {
    for (const double gamma : config.svm.gamma_values) {
      SvmTrainingConfig svm;
      svm.c = c;
      svm.gamma = gamma;
      svm.max_vectors = config.svm.max_vectors;
      svm.seed = static_cast<std::uint64_t>(config.seed);
      learners.push_back({fmt::format("C {:g}, gamma {:g}", c, gamma), [=](const Pools& pools) {
                            const FeatureSet set = featureSet(config);
                            const auto examples = chooseSvmExamples(pools, config.svm, config.seed);
                            return RankerModel(set, trainScaledSvm(examples, set, true, svm),
                                               trainScaledSvm(examples, set, false, svm));
                          }});
    }
  }
  return learners;
}

std::vector<RankerLearner> treesLearners(const RankerTrainingConfig& config) {
  std::vector<RankerLearner> learners;
  for (const double count : config.trees.counts) {
    for (const double questions : config.trees.questions) {
      BoostingConfig boosting;
      boosting.trees = static_cast<int>(count);
      boosting.questions = static_cast<int>(questions);
      boosting.rate = config.trees.rate;
      boosting.ridge = config.trees.ridge;
      boosting.seed = static_cast<std::uint64_t>(config.seed);
      const auto judge = [=](const Pools& pools, bool with_depth) {
        return trainBoostedTrees(chooseTreeExamples(pools, featureSet(config), with_depth, config.trees, config.seed),
                                 boosting);
      };
      learners.push_back(
          {fmt::format("{} trees of {} questions", boosting.trees, boosting.questions), [=](const Pools& pools) {
             return RankerModel(featureSet(config), judge(pools, true), judge(pools, false));
           }});
    }
  }
  return learners;
}

}  // namespace

std::vector<RankerLearner> rankerLearners(const RankerTrainingConfig& config) {
  return config.learner == "svm" ? svmLearners(config) : treesLearners(config);
}

}  // namespace saccade
