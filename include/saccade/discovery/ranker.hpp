#pragma once

#include <span>
#include <vector>

#include "saccade/core/config_fields.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/candidate_features.hpp"
#include "saccade/discovery/perception.hpp"
#include "saccade/discovery/ranker_model.hpp"

namespace saccade {

struct RankingConfig {
  bool paper = false;
  int top_k = 20;
  int max_open = 255;
  int max_judged = 700;
  int max_convexities = 500;
  double duplicate_iou = 0.9;
  bool suppress = true;
  double suppress_from = 0.3;
  double suppress_power = 0.25;
  double cover_power = 0.25;
  double inside_from = 0.6;
  double inside_loss = 0.1;
  double min_score = 0.07;
  double unmeasured_weight = 0.5;
  double familiar_loss = 0.5;
  FeatureConfig features;

  void describe(ConfigVisitor& v) {
    v.flag("paper", paper, "twelve features, no duplicates merged, nothing suppressed");
    v.integer("top_k", top_k, {0, 255}, "", "candidates attended in a frame");
    v.integer("max_open", max_open, {1, 100000}, "", "candidates reported of a frame");
    v.integer("max_judged", max_judged, {0, 1000000}, "",
              "candidates that are left once all are scored with a mean convexity; 0 = all, as the paper does");
    v.integer("max_convexities", max_convexities, {0, 1000000}, "",
              "of them, those that score best are scored again with their own convexity; 0 = all, as the paper does");
    v.number("duplicate_iou", duplicate_iou, {0.0, 1.0}, "", "mask overlap from which the weaker of two is left out");
    v.flag("suppress", suppress,
           "candidates that overlap a better one lose score, so that the best are of many things");
    v.number("suppress_from", suppress_from, {0.0, 1.0}, "", "box overlap from which score is lost");
    v.number("suppress_power", suppress_power, {0.0, 100.0}, "", "how steeply the score falls to 0 at full overlap");
    v.number("cover_power", cover_power, {0.0, 100.0}, "",
             "the same (if steeper) for candidates after the first top_k: 1 misses least and repeats nothing");
    v.number("inside_from", inside_from, {0.0, 1.0}, "",
             "share of a box inside a better one's from which score is lost besides");
    v.number("inside_loss", inside_loss, {0.0, 1.0}, "",
             "share of its score that a box wholly inside a better one loses");
    v.number("min_score", min_score, {0.0, 1.0}, "",
             "the list ends after the first top_k where scores fall below this; 0 with cover_power 1 misses least");
    v.number("unmeasured_weight", unmeasured_weight, {0.0, 1.0}, "",
             "factor on the score of candidates that depth hardly shows (features.min_depth_share): few leaves can "
             "remember them");
    v.number("familiar_loss", familiar_loss, {0.0, 1.0}, "",
             "share of its score that a candidate loses of which all was attended and is forgotten, however long ago: "
             "what is new is looked at first");
    v.section("features", features, "measuring candidates");
  }
};

/// Ranks candidates by the model's probability that they are objects (paper, "Ranking of the candidates").
///
/// Owns the model and scratch memory; what is attended is the caller's. Not thread-safe; one per thread. Candidates are
/// measured by as many threads as are idle.
class Ranker {
 public:
  /// Uses the built-in model: that of the paper's features if `config.paper`, else the extended one.
  explicit Ranker(RankingConfig config = {});
  Ranker(RankingConfig config, RankerModel model);

  /// Returns the best `max_open` of `open`, measured, scored and sorted by falling score; ties go by source, then by
  /// the pool's order. All are scored with a mean convexity first; the best `max_judged` are left, and the best
  /// `max_convexities` of them are scored again with their own, unless `config.paper`. Duplicates (masks alike) keep
  /// the better score only. With suppression the score of a candidate is the model's probability, lowered by its
  /// overlap with those ranked before it (as Bodla et al. 2017), by `suppress_power` among the first `top_k`, which are
  /// attended, by `cover_power` after them, and by up to `inside_loss` if it lies inside one of them. There the list
  /// ends with the last score of `min_score` or more, unless `config.paper`. In frames with depth, candidates that it
  /// does not show (`has_depth`) weigh `unmeasured_weight`, and what was attended and is forgotten loses up to
  /// `familiar_loss`, unless `config.paper`.
  [[nodiscard]] Candidates rank(Candidates open, const Perception& seen);

  /// rank(), cut to `k`.
  [[nodiscard]] Candidates best(Candidates open, const Perception& seen, int k);

  [[nodiscard]] const RankingConfig& config() const { return config_; }
  [[nodiscard]] const RankerModel& model() const { return model_; }

 private:
  void score(Candidates& open, const Perception& seen) const;
  void judge(Candidates& open, const Perception& seen);
  void measureConvexities(std::span<Candidate> candidates, const Perception& seen, double least);

  RankingConfig config_;
  RankerModel model_;
  std::vector<CandidateMeasurer> measurers_;  ///< one for each part of the candidates that is measured by itself
};

/// Orders `sorted` (by falling score) anew as Ranker::rank does, duplicates left in. Ties: the earlier in `sorted`.
void suppressOverlapping(Candidates& sorted, const RankingConfig& config);

/// Pascal overlap of two boxes: intersection over union, 0..1.
[[nodiscard]] double boxIou(const cv::Rect& a, const cv::Rect& b);

/// Intersection over union of two candidates' masks, 0..1, from the segments' areas alone.
[[nodiscard]] double maskIou(const Candidate& a, const Candidate& b, const Perception& seen);

}  // namespace saccade
