#include "saccade/evaluation/compared_methods.hpp"

#include <algorithm>
#include <chrono>
#include <random>

#include "saccade/discovery/candidate_features.hpp"
#include "saccade/evaluation/rival_proposals.hpp"

namespace saccade {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Candidates fromSource(Candidates pool, CandidateSource source) {
  std::erase_if(pool, [source](const Candidate& candidate) { return candidate.source != source; });
  return pool;
}

double meanSaliency(const Candidate& candidate, const Perception& seen) {
  double sum = 0.0;
  for (const std::int32_t segment : candidate.segments) sum += seen.table(candidate.source).sums(segment).saliency;
  return candidate.area > 0 ? sum / candidate.area : 0.0;
}

template <typename Value>
Candidates byFalling(Candidates pool, const Value& value) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < pool.size(); ++i) order.emplace_back(-value(pool[i]), i);
  std::sort(order.begin(), order.end());
  Candidates sorted;
  for (const auto& [key, i] : order) sorted.push_back(std::move(pool[i]));
  return sorted;
}

}  // namespace

void MethodScore::finish(int frames) {
  if (frames == 0) return;
  candidates /= frames;
  ms /= frames;
}

ComparedMethods::ComparedMethods(const ComparisonOptions& options, const DiscoveryConfig& discovery,
                                 const std::optional<RankerModel>& model, const DiscoveryRules& rules)
    : rules_(rules), ranker_(model ? Ranker(discovery.ranking, *model) : Ranker(discovery.ranking)) {
  const auto addOrdering = [&](const char* name, Order order) {
    MethodScore score{name, DiscoveryScore(rules.max_candidates), DiscoveryScore(rules.max_candidates)};
    orderings_.push_back({std::move(score), std::move(order)});
  };
  const auto addRival = [&](const char* name, Rival propose) {
    MethodScore score{name, DiscoveryScore(rules.max_candidates), std::nullopt};
    score.boxes_as_many_as_ours.emplace(rules.max_candidates);
    rivals_.push_back({std::move(score), std::move(propose)});
  };
  if (options.sources) {
    addOrdering("colour", [this](Candidates pool, const Perception& seen) {
      return ranker_.rank(fromSource(std::move(pool), CandidateSource::kColor), seen);
    });
    addOrdering("depth", [this](Candidates pool, const Perception& seen) {
      return ranker_.rank(fromSource(std::move(pool), CandidateSource::kDepth), seen);
    });
  }
  if (options.baselines) {
    addOrdering("ordered by area", [](Candidates pool, const Perception&) {
      return byFalling(std::move(pool), [](const Candidate& candidate) { return double(candidate.area); });
    });
    addOrdering("ordered by saliency", [](Candidates pool, const Perception& seen) {
      return byFalling(std::move(pool), [&](const Candidate& candidate) { return meanSaliency(candidate, seen); });
    });
    addOrdering("random order", [random = std::mt19937_64(1)](Candidates pool, const Perception&) mutable {
      std::shuffle(pool.begin(), pool.end(), random);
      return pool;
    });
  }
  if (options.rivals) {
    addRival("Selective Search", selectiveSearchBoxes);
    addRival("Edge Boxes", edgeBoxes);
  }
}

void ComparedMethods::add(const RgbdFrame& frame, const Perception& seen, const Candidates& pool,
                          std::size_t our_count) {
  ++frames_;
  for (Ordering& method : orderings_) {
    const auto start = Clock::now();
    const Candidates ordered = method.order(pool, seen);
    method.score.ms += millisecondsSince(start);
    method.score.candidates += static_cast<double>(ordered.size());
    method.score.boxes.add(matchBoxes(ordered, frame.label, rules_));
    method.score.masks->add(matchMasks(ordered, seen, frame.label, rules_));
  }
  for (RivalMethod& rival : rivals_) {
    const auto start = Clock::now();
    std::vector<cv::Rect> boxes = rival.propose(frame.color);
    rival.score.ms += millisecondsSince(start);
    rival.score.candidates += static_cast<double>(boxes.size());
    rival.score.boxes.add(matchBoxes(boxes, frame.label, rules_));
    boxes.resize(std::min(boxes.size(), our_count));
    rival.score.boxes_as_many_as_ours->add(matchBoxes(boxes, frame.label, rules_));
  }
}

std::vector<MethodScore> ComparedMethods::finish() {
  std::vector<MethodScore> scores;
  for (Ordering& method : orderings_) scores.push_back(std::move(method.score));
  for (RivalMethod& rival : rivals_) scores.push_back(std::move(rival.score));
  for (MethodScore& score : scores) score.finish(frames_);
  return scores;
}

}  // namespace saccade
