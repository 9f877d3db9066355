#include "saccade/evaluation/run_score.hpp"

#include <algorithm>
#include <numeric>

namespace saccade {
namespace {

constexpr double kRevisitShare = 0.5;

double revisitRate(const RecordedFrame& frame, double otherwise) {
  int attended = 0, revisits = 0;
  for (const RecordedCandidate& candidate : frame.open) {
    if (!candidate.attended || !candidate.revisited_share) continue;
    ++attended;
    revisits += *candidate.revisited_share >= kRevisitShare ? 1 : 0;
  }
  return attended > 0 ? static_cast<double>(revisits) / attended : otherwise;
}

bool saysRevisits(const RunRecording& recording) {
  return std::any_of(recording.frames.begin(), recording.frames.end(), [](const RecordedFrame& frame) {
    return std::any_of(frame.open.begin(), frame.open.end(),
                       [](const RecordedCandidate& candidate) { return candidate.revisited_share.has_value(); });
  });
}

}  // namespace

double RunScore::meanRevisitRate() const {
  if (revisit_rate.empty()) return 0.0;
  return std::accumulate(revisit_rate.begin(), revisit_rate.end(), 0.0) / static_cast<double>(revisit_rate.size());
}

RunScore scoreRun(const RunRecording& recording, const LabelFrames& labels, const DiscoveryRules& rules) {
  RunScore score;
  score.boxes = score.masks = DiscoveryScore(rules.max_candidates);
  const bool says_revisits = saysRevisits(recording);
  std::vector<double> times;
  for (const RecordedFrame& frame : recording.frames) {
    const int position = score.frames++;
    score.inhibited += frame.inhibited;
    times.push_back(frame.processing_ms);
    if (says_revisits) {
      score.revisit_rate.push_back(revisitRate(frame, score.revisit_rate.empty() ? 0.0 : score.revisit_rate.back()));
    }
    const std::optional<cv::Mat1w> label = labels.find(frame.name);
    if (!label) continue;
    std::vector<cv::Rect> boxes;
    std::vector<std::string> masks;
    for (const RecordedCandidate& candidate : frame.open) {
      boxes.push_back(candidate.box);
      masks.push_back(candidate.mask);
    }
    score.boxes.add(matchBoxes(boxes, *label, rules));
    score.masks.add(matchMasks(masks, *label, rules));
    score.labelled_frames.push_back(position);
    ++score.labelled;
  }
  if (score.frames == 0) return score;
  score.inhibited /= score.frames;
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  score.median_ms = times[times.size() / 2];
  return score;
}

}  // namespace saccade
