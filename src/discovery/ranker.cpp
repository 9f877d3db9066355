#include "saccade/discovery/ranker.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

namespace saccade {
namespace {

/// Candidates are measured in this many parts: few, as each prepares for the frame anew.
constexpr std::size_t kMeasuredParts = 4;

const RankingConfig& checked(const RankingConfig& config) {
  requireValid(config);
  return config;
}

double area(const cv::Rect& box) {
  return static_cast<double>(box.width) * box.height;
}

/// Pixels that two boxes share.
double sharedArea(const cv::Rect& a, const cv::Rect& b) {
  const int width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const int height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return width > 0 && height > 0 ? static_cast<double>(width) * height : 0.0;
}

int sharedPixels(const Candidate& a, const Candidate& b, const Perception& seen) {
  int pixels = 0;
  if (a.source == b.source) {
    const SegmentTable& table = seen.table(a.source);
    for (auto i = a.segments.begin(), j = b.segments.begin(); i != a.segments.end() && j != b.segments.end();) {
      if (*i == *j) {
        pixels += table.sums(*i).area;
        ++i, ++j;
      } else {
        *i < *j ? ++i : ++j;
      }
    }
    return pixels;
  }
  const Candidate &color = a.source == CandidateSource::kColor ? a : b, &depth = &color == &a ? b : a;
  for (const std::int32_t segment : color.segments) {
    auto member = depth.segments.begin();
    for (const SegmentOverlap::Share& share : seen.overlap.ofFirst(segment)) {
      member = std::lower_bound(member, depth.segments.end(), share.other);
      if (member == depth.segments.end()) break;
      if (*member == share.other) pixels += share.pixels;
    }
  }
  return pixels;
}

/// Whether two masks overlap by at least `least_iou`. They cannot share more than their boxes do, nor be more alike
/// than their areas are.
bool areAlike(const Candidate& a, const Candidate& b, double least_iou, const Perception& seen) {
  const double least_shared = least_iou * std::max(a.area, b.area);
  return std::min(a.area, b.area) >= least_shared && (a.box & b.box).area() >= least_shared &&
         maskIou(a, b, seen) >= least_iou;
}

/// A candidate that waits for its turn, with the score it had after overlapping the first `met` of those taken.
struct Waiting {
  double score;
  std::size_t index, met;
  bool operator<(const Waiting& other) const {
    return score != other.score ? score < other.score : index > other.index;
  }
};

/// Takes candidates one by one, the best first, whose scores fall with their overlap with those taken. Scores only ever
/// fall: one needs to be brought up to date only when it is the highest, and most candidates never are.
class Queue {
 public:
  /// `sorted`: by falling score, must outlive the queue, as must `config`, which says what overlap costs.
  Queue(const Candidates& sorted, const RankingConfig& config)
      : sorted_(sorted), config_(config), is_out_(sorted.size(), 0) {
    heap_.reserve(sorted.size());
  }

  /// Every candidate that is still in starts again from its own score; from now on overlap lowers it by `power`.
  void restart(double power) {
    power_ = power;
    heap_.clear();
    for (std::size_t i = 0; i < sorted_.size(); ++i) {
      if (is_out_[i] == 0) heap_.push_back({sorted_[i].score, i, 0});  // by falling score: a heap as it is
    }
  }
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  /// Removes and returns the best. What it overlaps counts from here on only if it is taken.
  Waiting pop() {
    while (true) {
      std::pop_heap(heap_.begin(), heap_.end());
      Waiting next = heap_.back();
      heap_.pop_back();
      const double before = next.score;
      for (; next.met < taken_.size(); ++next.met) next.score *= kept(taken_[next.met], sorted_[next.index].box);
      if (next.score >= before) {
        is_out_[next.index] = 1;
        return next;
      }
      heap_.push_back(next);
      std::push_heap(heap_.begin(), heap_.end());
    }
  }
  void take(const Waiting& chosen) { taken_.push_back(sorted_[chosen.index].box); }

 private:
  /// The share of its score that `box` keeps beside one taken.
  [[nodiscard]] double kept(const cv::Rect& taken, const cv::Rect& box) const {
    if (power_ <= 0.0) return 1.0;
    const double shared = sharedArea(taken, box);
    if (shared <= 0.0) return 1.0;
    const double over = shared / (area(taken) + area(box) - shared) - config_.suppress_from;
    const double inside = shared / area(box) - config_.inside_from;
    double share = over > 0.0 ? std::pow(1.0 - over / (1.0 - config_.suppress_from), power_) : 1.0;
    if (inside > 0.0) share *= 1.0 - config_.inside_loss * inside / (1.0 - config_.inside_from);
    return share;
  }

  const Candidates& sorted_;
  const RankingConfig& config_;
  double power_ = 0.0;
  std::vector<char> is_out_;
  std::vector<Waiting> heap_;
  std::vector<cv::Rect> taken_;
};

/// Leaves the `most` candidates that score best, in their order.
void keepBest(Candidates& candidates, std::size_t most) {
  if (candidates.size() <= most) return;
  std::vector<std::size_t> best(candidates.size());
  std::iota(best.begin(), best.end(), std::size_t{0});
  const auto cut = best.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(best.begin(), cut, best.end(), [&candidates](std::size_t i, std::size_t j) {
    const Candidate &a = candidates[i], &b = candidates[j];
    return a.score != b.score ? a.score > b.score : i < j;
  });
  std::sort(best.begin(), cut);
  for (std::size_t i = 0; i < most; ++i) {
    if (best[i] != i) candidates[i] = std::move(candidates[best[i]]);
  }
  candidates.resize(most);
}

/// The score of the candidate of this rank, from 0 on; 0 if there are not so many.
double scoreAt(const Candidates& candidates, std::size_t rank) {
  if (candidates.size() <= rank) return 0.0;
  std::vector<double> scores;
  scores.reserve(candidates.size());
  for (const Candidate& candidate : candidates) scores.push_back(candidate.score);
  const auto at = scores.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(scores.begin(), at, scores.end(), std::greater<>());
  return *at;
}

/// Takes the best `config.max_open`, those beyond the first `config.top_k` by cover_power and down to min_score.
/// `isNew(candidate, better)` is asked of each before it is taken, with those taken before it.
template <typename IsNew>
Candidates takeBest(Candidates sorted, const RankingConfig& config, const IsNew& isNew) {
  const bool suppress = config.suppress && !config.paper;
  const auto top_k = static_cast<std::size_t>(config.top_k);
  Queue queue(sorted, config);
  const double cover_power = std::max(config.suppress_power, config.cover_power);  // no score may rise again
  queue.restart(!suppress ? 0.0 : top_k > 0 ? config.suppress_power : cover_power);
  std::vector<const Candidate*> better;
  std::vector<Waiting> taken;
  better.reserve(sorted.size());
  taken.reserve(sorted.size());
  while (!queue.empty() && taken.size() < static_cast<std::size_t>(config.max_open)) {
    const Waiting next = queue.pop();
    if (!config.paper && taken.size() >= top_k && next.score < config.min_score) break;
    const Candidate& candidate = sorted[next.index];
    if (!isNew(candidate, better)) continue;
    better.push_back(&candidate);
    taken.push_back(next);
    queue.take(next);
    if (suppress && taken.size() == top_k && cover_power > config.suppress_power) queue.restart(cover_power);
  }
  Candidates best;
  best.reserve(taken.size());
  for (const Waiting& chosen : taken) {
    best.push_back(std::move(sorted[chosen.index]));
    best.back().score = chosen.score;
  }
  return best;
}

}  // namespace

double boxIou(const cv::Rect& a, const cv::Rect& b) {
  const double shared = sharedArea(a, b);
  return shared > 0.0 ? shared / (area(a) + area(b) - shared) : 0.0;
}

double maskIou(const Candidate& a, const Candidate& b, const Perception& seen) {
  const double shared = sharedPixels(a, b, seen), together = static_cast<double>(a.area) + b.area - shared;
  return together > 0.0 ? shared / together : 0.0;
}

Ranker::Ranker(RankingConfig config)
    : Ranker(config, RankerModel::builtIn(config.paper ? FeatureSet::kPaper : FeatureSet::kExtended)) {}

Ranker::Ranker(RankingConfig config, RankerModel model)
    : config_(checked(config)),
      model_(std::move(model)),
      measurers_(kMeasuredParts, CandidateMeasurer(config.features)) {}

/// Calls `work(measurer, candidates)` for each part of the candidates, on as many threads as are idle.
template <typename Work>
void forEachPart(std::span<Candidate> candidates, std::vector<CandidateMeasurer>& measurers, const Work& work) {
  const std::size_t parts = measurers.size();
  tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    const std::size_t begin = part * candidates.size() / parts, end = (part + 1) * candidates.size() / parts;
    if (begin < end) work(measurers[part], candidates.subspan(begin, end - begin));
  });
}

/// The model's probabilities; what depth hardly shows gives way to what can be remembered in the map, and what was
/// attended and forgotten to what is new.
void Ranker::score(Candidates& open, const Perception& seen) const {
  model_.score(open);
  if (config_.paper) return;
  for (Candidate& candidate : open) {
    if (seen.has_depth && !candidate.has_depth) candidate.score *= config_.unmeasured_weight;
    candidate.score *= 1.0 - config_.familiar_loss * candidate.familiar_share;
  }
}

/// Of all candidates that the built-in ranker was trained on.
constexpr float kMeanConvexity_m = 0.022F;

/// Measures the convexity of those that score at least `least` and have none yet.
void Ranker::measureConvexities(std::span<Candidate> candidates, const Perception& seen, double least) {
  forEachPart(candidates, measurers_, [&](CandidateMeasurer& measurer, std::span<Candidate> part) {
    for (Candidate& candidate : part) {
      const bool is_missing = candidate.has_depth && !candidate.has_convexity;
      if (is_missing && candidate.score >= least) measurer.measureConvexity(candidate, seen);
    }
  });
}

/// Of candidates that are measured but for their convexity, which takes half of the time of all features, those that
/// score best with a mean one are left, and the best of these get their own.
void Ranker::judge(Candidates& open, const Perception& seen) {
  const auto limit = [&](int most) {
    return config_.paper || most == 0 ? open.size() : static_cast<std::size_t>(most);
  };
  const std::size_t judged = limit(config_.max_judged), measured = limit(config_.max_convexities);
  double least = 0.0;
  if (open.size() > std::min(judged, measured)) {
    for (Candidate& candidate : open) {
      if (candidate.has_depth) candidate.features[kFeatureConvexity] = kMeanConvexity_m;
    }
    score(open, seen);
    keepBest(open, judged);
    least = scoreAt(open, measured - 1);
  }
  measureConvexities(open, seen, least);
  score(open, seen);
}

Candidates Ranker::rank(Candidates open, const Perception& seen) {
  forEachPart(open, measurers_, [&](CandidateMeasurer& measurer, std::span<Candidate> part) {
    measurer.measureAllButConvexity(part, seen);
  });
  judge(open, seen);
  std::vector<std::size_t> order(open.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&open](std::size_t i, std::size_t j) {
    const Candidate &a = open[i], &b = open[j];
    if (a.score != b.score) return a.score > b.score;
    return a.source != b.source ? a.source < b.source : i < j;
  });
  Candidates sorted;
  sorted.reserve(order.size());
  for (const std::size_t i : order) sorted.push_back(std::move(open[i]));

  const auto isNew = [&](const Candidate& candidate, const std::vector<const Candidate*>& better) {
    return config_.paper || std::none_of(better.begin(), better.end(), [&](const Candidate* other) {
             return areAlike(*other, candidate, config_.duplicate_iou, seen);
           });
  };
  Candidates best = takeBest(std::move(sorted), config_, isNew);
  measureConvexities(best, seen, 0.0);  // what is told of a candidate is its own
  return best;
}

void suppressOverlapping(Candidates& sorted, const RankingConfig& config) {
  sorted = takeBest(std::move(sorted), config, [](const Candidate&, const auto&) { return true; });
}

Candidates Ranker::best(Candidates open, const Perception& seen, int k) {
  Candidates ranked = rank(std::move(open), seen);
  if (ranked.size() > static_cast<std::size_t>(std::max(0, k))) ranked.resize(static_cast<std::size_t>(std::max(0, k)));
  return ranked;
}

}  // namespace saccade
