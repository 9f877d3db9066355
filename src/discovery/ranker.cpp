#include "saccade/discovery/ranker.hpp"

#include <algorithm>
#include <cmath>

namespace saccade {
namespace {

const RankingConfig& checked(const RankingConfig& config) {
  requireValid(config);
  return config;
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

}  // namespace

double boxIou(const cv::Rect& a, const cv::Rect& b) {
  const int width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const int height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  if (width <= 0 || height <= 0) return 0.0;
  const double shared = static_cast<double>(width) * height;
  return shared / (static_cast<double>(a.width) * a.height + static_cast<double>(b.width) * b.height - shared);
}

double maskIou(const Candidate& a, const Candidate& b, const Perception& seen) {
  const double shared = sharedPixels(a, b, seen), together = static_cast<double>(a.area) + b.area - shared;
  return together > 0.0 ? shared / together : 0.0;
}

Ranker::Ranker(RankingConfig config)
    : Ranker(config, RankerModel::builtIn(config.paper ? FeatureSet::kPaper : FeatureSet::kExtended)) {}

Ranker::Ranker(RankingConfig config, RankerModel model)
    : config_(checked(config)), model_(std::move(model)), measurer_(config.features) {}

Candidates Ranker::rank(Candidates open, const Perception& seen) {
  measurer_.measure(open, seen);
  model_.score(open);
  const auto better = [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.source < b.source;
  };
  std::stable_sort(open.begin(), open.end(), better);
  if (config_.paper) {
    if (open.size() > static_cast<std::size_t>(config_.max_open)) {
      open.resize(static_cast<std::size_t>(config_.max_open));
    }
    return open;
  }
  Candidates kept;
  for (Candidate& candidate : open) {
    const bool duplicate = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
      const int smaller = std::min(other.area, candidate.area), larger = std::max(other.area, candidate.area);
      // Masks cannot be more alike than their areas are.
      return smaller >= config_.duplicate_iou * larger && (other.box & candidate.box).area() >= smaller / 2 &&
             maskIou(other, candidate, seen) >= config_.duplicate_iou;
    });
    if (!duplicate) kept.push_back(std::move(candidate));
  }
  if (config_.suppress) suppressOverlapping(kept, config_);
  if (kept.size() > static_cast<std::size_t>(config_.max_open)) kept.resize(static_cast<std::size_t>(config_.max_open));
  return kept;
}

void suppressOverlapping(Candidates& sorted, const RankingConfig& config) {
  struct Entry {
    double score;
    cv::Rect box;
    std::size_t index;
  };
  std::vector<Entry> waiting;
  for (std::size_t i = 0; i < sorted.size(); ++i) waiting.push_back({sorted[i].score, sorted[i].box, i});
  const std::size_t wanted = std::min(sorted.size(), static_cast<std::size_t>(config.max_open));
  Candidates ranked;
  while (ranked.size() < wanted) {
    auto best = waiting.begin();
    for (auto entry = waiting.begin(); entry != waiting.end(); ++entry) {
      if (entry->score > best->score || (entry->score == best->score && entry->index < best->index)) best = entry;
    }
    const Entry chosen = *best;
    *best = waiting.back();
    waiting.pop_back();
    ranked.push_back(std::move(sorted[chosen.index]));
    ranked.back().score = chosen.score;
    for (Entry& entry : waiting) {
      const double over = boxIou(chosen.box, entry.box) - config.suppress_from;
      if (over > 0.0) entry.score *= std::pow(1.0 - over / (1.0 - config.suppress_from), config.suppress_power);
    }
  }
  sorted = std::move(ranked);
}

Candidates Ranker::best(Candidates open, const Perception& seen, int k) {
  Candidates ranked = rank(std::move(open), seen);
  if (ranked.size() > static_cast<std::size_t>(std::max(0, k))) ranked.resize(static_cast<std::size_t>(std::max(0, k)));
  return ranked;
}

}  // namespace saccade
