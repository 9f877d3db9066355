#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "saccade/discovery/discovery_config.hpp"
#include "saccade/evaluation/compared_methods.hpp"
#include "saccade/evaluation/discovery_metrics.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {

/// One frame of an evaluation, while it lasts.
struct EvaluatedFrame {
  const RgbdFrame& frame;
  const DepthMaps* depth;  ///< null: colour only
  const Perception& seen;
  const Candidates& ranked;  ///< by falling score
};

struct EvaluationOptions {
  DiscoveryConfig discovery;
  std::optional<RankerModel> model;  ///< instead of the built-in one
  bool use_depth = true;
  DiscoveryRules rules;                          ///< ignore_from is the source's if that names one
  ComparisonOptions compare;                     ///< what else is judged on the same frames
  std::function<bool(const RgbdFrame&)> accept;  ///< if set: labelled frames for which it is false are skipped
  std::function<void(const EvaluatedFrame&)> on_frame;
};

/// What `saccade evaluate` reports of single frames: no inhibition, no map, every labelled frame for itself.
struct DiscoveryEvaluation {
  MethodScore ours;                 ///< colour + depth; its time is that of perception, proposals and ranking
  std::vector<MethodScore> others;  ///< as `compare` asks
  int frames = 0;                   ///< labelled frames evaluated
  double pool_size = 0.0;           ///< mean number of candidates before ranking
};

/// Runs discovery on all labelled frames of `source` and compares with their labels (paper, "Evaluation"; TARGETS:
/// recall and precision at k of boxes and of masks, Pascal overlap above 0.5). Frames without label are skipped.
[[nodiscard]] DiscoveryEvaluation evaluateFrames(FrameSource& source, const EvaluationOptions& options);

}  // namespace saccade
