#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "saccade/discovery/candidate.hpp"
#include "saccade/evaluation/ranker_training.hpp"

namespace saccade {

/// What the labels say of a candidate: it shows an object, something else, or neither for sure.
enum class Kind : std::uint8_t { kObject, kOther, kUndecided };

/// A frame's measured candidates with what the labels say of them. Holds no images.
struct LabelledPool {
  Candidates candidates;
  std::vector<Kind> kinds;
  std::vector<double> overlaps;  ///< of each candidate: its box's best with an object, 0..1
  std::vector<std::uint8_t>
      is_trusted;                       ///< of each candidate: depth was measured, so that it may be an example of none
  std::vector<std::vector<int>> shows;  ///< of each candidate: indices of the objects its box shows
  std::vector<int> object_ids;
  int fold = 0;  ///< of cross-validation
};

/// Proposes, measures and judges the candidates of every labelled frame with depth of `inputs`. Folds are runs of
/// consecutive frames of each input, since neighbouring frames of a sequence look alike. Throws IoError if an input
/// cannot be opened.
[[nodiscard]] std::vector<LabelledPool> readLabelledPools(const std::vector<std::string>& inputs,
                                                          const RankerTrainingConfig& config);

}  // namespace saccade
