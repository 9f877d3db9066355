#pragma once

#include <limits>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

/// Fixed by the benchmark (see the Pascal criterion in the paper's evaluation).
struct DiscoveryRules {
  double min_iou = 0.5;                               ///< a candidate shows an object if their overlap is *above* this
  int min_object_area = 200;                          ///< px; smaller objects are left out
  int ignore_from = std::numeric_limits<int>::max();  ///< ids from here on count neither for nor against
  int max_candidates = 255;
};

/// One labelled object as far as it is visible.
struct LabelledObject {
  int id = 0;
  int area = 0;
  cv::Rect box;  ///< width = max u - min u + 1
};

/// The objects of a label image that count, by rising id.
[[nodiscard]] std::vector<LabelledObject> labelledObjects(const cv::Mat1w& label, const DiscoveryRules& rules);

/// What the ranked candidates of one frame found, either by boxes or by masks.
struct FrameMatches {
  static constexpr int kNever = -1;

  std::vector<int> object_ids;
  std::vector<int> found_at;         ///< of each object: the rank of the first candidate that shows it, or kNever
  std::vector<char> is_right;        ///< of each candidate by rank: it shows an object
  std::vector<char> is_ignored;      ///< shows none, and more than half of its pixels are on ignored ids
  std::vector<double> best_overlap;  ///< of each object: the largest overlap with any candidate, 0..1
};

/// Compares boxes, best first; only the first `rules.max_candidates` are looked at. A box is ignored by the pixels of
/// the whole box.
[[nodiscard]] FrameMatches matchBoxes(const std::vector<cv::Rect>& ranked, const cv::Mat1w& label,
                                      const DiscoveryRules& rules);
[[nodiscard]] FrameMatches matchBoxes(const Candidates& ranked, const cv::Mat1w& label, const DiscoveryRules& rules);

/// The same with pixel masks; a mask is ignored by its own pixels.
[[nodiscard]] FrameMatches matchMasks(const Candidates& ranked, const Perception& seen, const cv::Mat1w& label,
                                      const DiscoveryRules& rules);
/// The same with masks as compressed COCO run lengths. Throws std::invalid_argument for one that does not fit the
/// label.
[[nodiscard]] FrameMatches matchMasks(const std::vector<std::string>& ranked, const cv::Mat1w& label,
                                      const DiscoveryRules& rules);

/// Intersection over union of a candidate's mask with each object of `objects`.
[[nodiscard]] std::vector<double> maskOverlaps(const Candidate& candidate, const Perception& seen,
                                               const cv::Mat1w& label, const std::vector<LabelledObject>& objects);

/// Recall, precision and F over many frames (paper, "Evaluation"): means over frames, as `judge.py recall` has them.
class DiscoveryScore {
 public:
  explicit DiscoveryScore(int max_candidates = 255) : max_candidates_(max_candidates) {}

  void add(const FrameMatches& frame);

  /// Frames with at least one object.
  [[nodiscard]] int frames() const { return static_cast<int>(recall_sum_frames_); }
  /// Mean over frames with objects of the share of objects found among the first k candidates. 0 without frames.
  [[nodiscard]] double recall(int k) const;
  /// Mean over frames of right / (candidates - ignored) among the first k; frames where nothing counts are left out.
  [[nodiscard]] double precision(int k) const;
  /// Harmonic mean of precision(k) and recall(k); 0 if both are.
  [[nodiscard]] double fScore(int k) const;
  /// Area under precision over 1 .. max_candidates, divided by max_candidates.
  [[nodiscard]] double precisionAuc() const;
  /// Mean over frames with objects of the mean over objects of the best overlap.
  [[nodiscard]] double meanBestOverlap() const;
  /// Area under recall over 1 .. max_candidates, divided by max_candidates.
  [[nodiscard]] double recallAuc() const;
  /// Share of all distinct object ids that any frame found among its first k.
  [[nodiscard]] double globalRecall(int k) const;
  /// The same after each frame: share of the distinct ids of the *whole* sequence found up to it.
  [[nodiscard]] std::vector<double> globalRecallOverTime(int k) const;

 private:
  int max_candidates_;
  std::size_t recall_sum_frames_ = 0;
  std::vector<FrameMatches> frames_;
};

}  // namespace saccade
