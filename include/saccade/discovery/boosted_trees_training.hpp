#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saccade/discovery/boosted_trees.hpp"

namespace saccade {

/// Examples for boosting: one row of `dimension` values each.
struct BoostingExamples {
  std::size_t dimension = 0;
  std::vector<float> rows;
  std::vector<float> targets;  ///< 0..1: how far the row is what is sought; anything between is a probability
  std::vector<float> weights;  ///< above 0

  [[nodiscard]] std::size_t size() const { return targets.size(); }
};

struct BoostingConfig {
  int trees = 300;
  int questions = 6;          ///< of each tree
  double rate = 0.1;          ///< by which each tree's correction is shortened
  double ridge = 5.0;         ///< keeps leaves of little weight near 0
  double row_share = 0.7;     ///< of the examples that each tree sees
  double column_share = 0.5;  ///< of the columns that each tree may ask for
  std::uint64_t seed = 1;
};

/// Fits a sum of oblivious trees to the targets by gradient boosting on the logistic loss: each tree is a Newton step
/// on a part of rows and columns drawn anew. Questions are sought among up to 127 quantiles of each column.
/// Deterministic at any number of threads. Throws std::invalid_argument if the sizes disagree or there is no example.
///
/// 100 000 rows of 50 values, 300 trees of 6 questions: about 15 s on two cores.
[[nodiscard]] BoostedTrees trainBoostedTrees(const BoostingExamples& examples, const BoostingConfig& config);

}  // namespace saccade
