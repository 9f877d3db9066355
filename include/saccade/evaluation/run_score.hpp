#pragma once

#include <vector>

#include "saccade/evaluation/discovery_metrics.hpp"
#include "saccade/evaluation/label_frames.hpp"
#include "saccade/evaluation/run_recording.hpp"

namespace saccade {

/// What one run over a sequence discovered, compared with the labels of some or all of its frames.
struct RunScore {
  DiscoveryScore boxes, masks;  ///< over the frames with a label, in order
  int frames = 0;               ///< of the run
  int labelled = 0;             ///< of them with a label
  double inhibited = 0.0;       ///< mean number of inhibited candidates a frame
  double median_ms = 0.0;       ///< of processing a frame; 0 if the record does not say
  /// Per frame of the run: share of the attended candidates of which at least half of the leaves were attended at an
  /// earlier tick. Frames that attended nothing repeat the value before them. Empty if the record does not say.
  std::vector<double> revisit_rate;
  std::vector<int> labelled_frames;  ///< position in the run of each labelled frame: the x of curves over time

  /// Mean of revisit_rate; 0 if there is none.
  [[nodiscard]] double meanRevisitRate() const;
};

/// Scores `recording` by `labels`. Throws std::invalid_argument if a mask does not fit its label image.
[[nodiscard]] RunScore scoreRun(const RunRecording& recording, const LabelFrames& labels, const DiscoveryRules& rules);

}  // namespace saccade
