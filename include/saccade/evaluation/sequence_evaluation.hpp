#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "saccade/evaluation/compared_methods.hpp"
#include "saccade/evaluation/label_propagation.hpp"
#include "saccade/evaluation/run_score.hpp"
#include "saccade/evaluation/trajectory_error.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/given_poses.hpp"

namespace saccade {

/// Values of one setting, each of which gets a run of its own.
struct Variation {
  std::string setting;              ///< as in --set, for example map.ior.mf
  std::vector<std::string> values;  ///< for example 2, 4, 6
};

struct SequenceOptions {
  ExplorerConfig config;
  std::optional<RankerModel> model;  ///< instead of the built-in one
  FrameRange range;
  std::filesystem::path labels;     ///< folder of label images; empty: the input's own
  int labels_every = 1;             ///< uses only each nth label, and propagates these
  bool propagate = false;           ///< runs are judged on every frame, labels are carried to those without
  std::filesystem::path truth;      ///< TUM trajectory to judge the tracking by; empty: the input's own poses, if any
  std::optional<GivenPoses> poses;  ///< believed instead of tracking
  ComparisonOptions compare;        ///< other methods on the labelled frames
  std::vector<Variation> variations;
  DiscoveryRules rules;  ///< ignore_from is that of the labels if they name one
  std::function<void(const std::string& run, std::int64_t done, std::int64_t total)> on_progress;
};

/// One run over the sequence.
struct SequenceRun {
  std::string name;
  RunScore score;
};

/// Everything that was measured on one sequence.
struct SequenceEvaluation {
  std::string input;
  std::int64_t frames = 0, lost = 0;
  std::optional<AbsoluteError> ate;  ///< of the first run's tracking, if the truth is known
  std::optional<RelativeError> rpe;  ///< over one second
  MethodScore ours;                  ///< on single labelled frames, without memory
  std::vector<MethodScore> others;
  std::vector<SequenceRun> runs;  ///< without IOR, with IOR, then the variations (with IOR)
  LabelFrames labels;             ///< what the runs were judged by
  std::optional<int> ignore_from;
  std::optional<LabelAgreement> propagation;  ///< of propagated with true labels, where both are known
};

/// Evaluates discovery and IOR on one sequence (paper, "Evaluation").
///
/// The first run tracks and inhibits nothing; its poses serve the runs after it, so that these differ in their
/// attention alone, and its map carries the labels. Single-frame figures are measured on the labelled frames by
/// themselves. Throws IoError where the input or its labels cannot be used.
[[nodiscard]] SequenceEvaluation evaluateSequence(const std::string& input, const SequenceOptions& options);

}  // namespace saccade
