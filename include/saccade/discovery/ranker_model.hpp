#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "saccade/discovery/boosted_trees.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/svm.hpp"

namespace saccade {

/// What a ranker looks at: the paper's twelve features, or those and our cues.
enum class FeatureSet : std::uint8_t { kPaper, kExtended };

/// Number of values a judge of this kind gets. Without depth all that is measured in depth is left out.
[[nodiscard]] std::size_t featureCount(FeatureSet set, bool with_depth);

/// Names of the features a ranker with depth looks at, in the order of their values.
[[nodiscard]] std::vector<std::string_view> featureNames(FeatureSet set);

/// Appends the values of `candidate` for a judge of this kind to `row`.
void appendFeatures(const Candidate& candidate, FeatureSet set, bool with_depth, std::vector<float>& row);

/// An SVM and the scaling of its input: x' = (x - mean) / scale, each limited to ±kScaledLimit.
struct ScaledSvm {
  static constexpr float kScaledLimit = 6.0F;

  std::vector<float> mean;
  std::vector<float> scale;
  Svm svm;

  /// Scales `row` (one or more rows) in place.
  void scaleRows(std::span<float> rows) const;
};

/// What tells objects from the rest: the paper's SVM, or boosted trees.
using Judge = std::variant<ScaledSvm, BoostedTrees>;

/// The trained ranker: a judge for candidates with depth and one for those without (paper, "Ranking of the
/// candidates").
///
/// A text file: a header, and per judge either its scaling and the SVM in LIBSVM's own format, or its trees.
class RankerModel {
 public:
  RankerModel() = default;
  RankerModel(FeatureSet set, Judge with_depth, Judge without_depth);

  /// The model that is built into the library; src/discovery/models/README.md says how it was made.
  [[nodiscard]] static const RankerModel& builtIn(FeatureSet set);
  /// Throws IoError if the file cannot be read or holds no ranker.
  [[nodiscard]] static RankerModel load(const std::filesystem::path& path);
  /// Throws std::invalid_argument if `text` is no ranker.
  [[nodiscard]] static RankerModel parse(std::string_view text);
  /// Writes the model; load(save(m)) predicts the same. Throws IoError if the file cannot be written whole.
  void save(const std::filesystem::path& path) const;
  [[nodiscard]] std::string text() const;

  [[nodiscard]] FeatureSet featureSet() const { return set_; }
  [[nodiscard]] const Judge& judge(bool with_depth) const { return with_depth ? with_depth_ : without_depth_; }

  /// Sets the score of every candidate, whose features must have been measured.
  void score(Candidates& candidates) const;

 private:
  FeatureSet set_ = FeatureSet::kPaper;
  Judge with_depth_, without_depth_;
};

}  // namespace saccade
