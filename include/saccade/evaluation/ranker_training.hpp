#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "saccade/discovery/boosted_trees.hpp"
#include "saccade/discovery/discovery_config.hpp"
#include "saccade/evaluation/discovery_metrics.hpp"

namespace saccade {

/// The paper's SVM.
struct SvmLearnerConfig {
  int positives_per_frame = 16;
  int negatives_per_frame = 40;
  std::vector<double> c_values = {1.0, 4.0, 16.0};
  std::vector<double> gamma_values = {0.01, 0.03, 0.1};
  int max_vectors = 256;

  void describe(ConfigVisitor& v) {
    v.integer("positives_per_frame", positives_per_frame, {1, 100000}, "", "examples of objects from one frame");
    v.integer("negatives_per_frame", negatives_per_frame, {1, 100000}, "", "examples of the rest from one frame");
    v.numbers("c", c_values, {1e-6, 1e6}, "", "values of the SVM's C that are tried");
    v.numbers("gamma", gamma_values, {1e-6, 1e6}, "", "widths of the RBF kernel that are tried");
    v.integer("max_vectors", max_vectors, {10, 100000}, "", "support vectors of each of the two SVMs, at most");
  }
};

/// Boosted trees, whose examples are not objects or none but are graded by overlap.
struct TreesLearnerConfig {
  double no_object = 0.25;
  double whole_object = 0.75;
  int others_per_frame = 200;
  double balance = 0.5;
  std::vector<double> counts = {300.0};
  std::vector<double> questions = {8.0};
  double rate = 0.1;
  double ridge = 5.0;

  void describe(ConfigVisitor& v) {
    v.number("no_object", no_object, {0.0, 0.5}, "", "box overlap up to which a candidate is worth 0");
    v.number("whole_object", whole_object, {0.5, 1.0}, "", "box overlap from which it is worth 1");
    v.integer("others_per_frame", others_per_frame, {1, 100000}, "",
              "examples worth less than 0.5 from one frame; of the others all are taken");
    v.number("balance", balance, {0.0, 1.0}, "",
             "0: every candidate of an object weighs the same; 1: all candidates of an object as much as another's");
    v.numbers("counts", counts, {1, 10000}, "", "numbers of trees that are tried");
    v.numbers("questions", questions, {1, BoostedTrees::kMostQuestions}, "", "numbers of questions a tree, tried");
    v.number("rate", rate, {1e-3, 1.0}, "", "by which each tree's correction is shortened");
    v.number("ridge", ridge, {0.0, 1e6}, "", "keeps leaves of few examples near 0");
  }
};

struct RankerTrainingConfig {
  DiscoveryConfig discovery;  ///< `discovery.ranking.paper` chooses the paper's twelve features
  std::string learner = "trees";
  SvmLearnerConfig svm;
  TreesLearnerConfig trees;
  double positive_iou = 0.55;
  double negative_iou = 0.5;
  double min_negative_depth = 0.5;
  double full_coverage = 0.7;
  int folds = 2;
  bool ablation = false;
  int seed = 1;

  void describe(ConfigVisitor& v) {
    v.section("discovery", discovery, "how candidates are made and ranked");
    v.text("learner", learner, {"trees", "svm"}, "what is trained");
    v.section("svm", svm, "examples and parameters of the SVM");
    v.section("trees", trees, "examples and parameters of the boosted trees");
    v.number("positive_iou", positive_iou, {0.0, 1.0}, "", "box and mask overlap above which a candidate is an object");
    v.number("negative_iou", negative_iou, {0.0, 1.0}, "", "box and mask overlap below which it is none");
    v.number("min_negative_depth", min_negative_depth, {0.0, 1.0}, "",
             "share of a negative's mask and of its outline that must have depth");
    v.number("full_coverage", full_coverage, {0.0, 1.0}, "",
             "share of a frame's pixels with depth from which negatives are taken without it, too");
    v.integer("folds", folds, {2, 100}, "", "cross-validation: parts of consecutive frames of each input");
    v.flag("ablation", ablation, "cross-validate without each feature in turn too, to tell what each is worth");
    v.integer("seed", seed, {0, 1000000000}, "", "chooses the examples");
  }

  /// The paper's way: its candidates, its twelve features, its SVM.
  void usePaperOnly() {
    discovery.usePaperOnly();
    learner = "svm";
  }
};

/// What cross-validation said of one set of parameters, on held-out frames: area under the ROC curve of single
/// candidates, and recall of the ranked lists by boxes.
struct RankerTrial {
  std::string settings;  ///< for people
  double auc = 0.0;
  double recall_at_5 = 0.0, recall_at_10 = 0.0, recall_at_20 = 0.0;

  /// What is maximised. Recall at 20 alone saturates on scenes of few objects, so the first ranks count too.
  [[nodiscard]] double merit() const { return (recall_at_5 + recall_at_10 + 2.0 * recall_at_20) / 4.0; }
};

/// What cross-validation loses without one feature.
struct FeatureValue {
  std::string_view name;
  double auc_lost = 0.0;
  double merit_lost = 0.0;  ///< of RankerTrial::merit()
};

struct RankerTraining {
  RankerModel model;
  std::vector<RankerTrial> trials;
  RankerTrial chosen;
  std::vector<FeatureValue> ablation;  ///< with the chosen parameters; empty unless asked for
  int frames = 0;
  int objects = 0, others = 0;  ///< candidates that show an object, or something else for sure
};

/// Trains the ranker on the labelled frames of `inputs`, as `saccade train`. An input is anything openSource opens,
/// with a range of frames after an @ if not all are wanted: `sim:flat?seed=11@::500`.
///
/// A candidate shows an object if it overlaps a labelled one well, and the rest if it shows none by the Pascal
/// criterion (so parts of objects count too: they are what takes objects' places in a list) and lies where depth was
/// measured (data sets that crop the depth of the background would teach "no depth = no object"). The SVM learns from
/// these; the trees learn from all, those between too, graded by overlap. Parameters are chosen by cross-validation
/// over whole frames, by the recall of the ranked lists, not by the accuracy of single decisions. Deterministic. Throws
/// IoError if an input cannot be opened, std::invalid_argument if there is nothing to learn from.
[[nodiscard]] RankerTraining trainRanker(const std::vector<std::string>& inputs, const RankerTrainingConfig& config);

}  // namespace saccade
