#pragma once

#include <functional>
#include <string>
#include <vector>

#include "labelled_pool.hpp"
#include "saccade/discovery/ranker_model.hpp"
#include "saccade/evaluation/ranker_training.hpp"

namespace saccade {

/// One way to train a ranker: what is learnt from the same frames is always the same.
struct RankerLearner {
  std::string settings;  ///< for people
  std::function<RankerModel(const std::vector<const LabelledPool*>& pools)> train;
};

/// A learner for each combination of the settings of `config.learner` that are to be tried.
[[nodiscard]] std::vector<RankerLearner> rankerLearners(const RankerTrainingConfig& config);

}  // namespace saccade
