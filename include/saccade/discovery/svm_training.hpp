#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saccade/discovery/svm.hpp"

namespace saccade {

/// Examples for a classifier: one row of `dimension` scaled values each.
struct SvmExamples {
  std::size_t dimension = 0;
  std::vector<float> rows;
  std::vector<std::int8_t> labels;  ///< +1 object, -1 none
  std::vector<int> groups;          ///< examples of one group (a frame) are never split between folds

  [[nodiscard]] std::size_t size() const { return labels.size(); }
};

struct SvmTrainingConfig {
  double c = 1.0;
  double gamma = 0.05;
  int folds = 4;
  int max_vectors = 600;
  std::uint64_t seed = 1;
};

/// Trains a C-SVC with RBF kernel by LIBSVM. The two classes weigh the same in total. If more than `max_vectors`
/// support vectors come out, a reduced set takes their place (kernel_expansion.hpp). The sigmoid that turns decisions
/// into probabilities (Platt 1999) is fitted on decisions about groups held out, not on single examples held out as
/// LIBSVM would. Throws std::invalid_argument if a class has no example or the sizes disagree. Deterministic.
[[nodiscard]] Svm trainSvm(const SvmExamples& examples, const SvmTrainingConfig& config);

/// Fold 0 .. folds - 1 of each group: groups in rising order, dealt round.
[[nodiscard]] std::vector<int> foldOfExamples(const std::vector<int>& groups, int folds);

}  // namespace saccade
