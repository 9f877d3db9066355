#include "saccade/evaluation/discovery_metrics.hpp"

#include <algorithm>

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/ranker.hpp"

namespace saccade {
namespace {

FrameMatches emptyMatches(const std::vector<LabelledObject>& objects) {
  FrameMatches matches;
  for (const LabelledObject& object : objects) matches.object_ids.push_back(object.id);
  matches.found_at.assign(objects.size(), FrameMatches::kNever);
  return matches;
}

std::size_t counted(const Candidates& ranked, const DiscoveryRules& rules) {
  return std::min(ranked.size(), static_cast<std::size_t>(std::max(0, rules.max_candidates)));
}

void note(FrameMatches& matches, const std::vector<double>& overlaps, double min_iou, int rank) {
  bool right = false;
  for (std::size_t i = 0; i < overlaps.size(); ++i) {
    if (!(overlaps[i] > min_iou)) continue;
    right = true;
    if (matches.found_at[i] == FrameMatches::kNever) matches.found_at[i] = rank;
  }
  matches.is_right.push_back(right ? 1 : 0);
}

}  // namespace

std::vector<LabelledObject> labelledObjects(const cv::Mat1w& label, const DiscoveryRules& rules) {
  struct Extent {
    int area = 0, min_u = 0, min_v = 0, max_u = 0, max_v = 0;
  };
  std::map<int, Extent> extents;
  for (int v = 0; v < label.rows; ++v) {
    for (int u = 0; u < label.cols; ++u) {
      const int id = label(v, u);
      if (id == 0 || id >= rules.ignore_from) continue;
      const auto [it, is_new] = extents.try_emplace(id, Extent{0, u, v, u, v});
      Extent& extent = it->second;
      ++extent.area;
      extent.min_u = std::min(extent.min_u, u);
      extent.max_u = std::max(extent.max_u, u);
      extent.max_v = v;
    }
  }
  std::vector<LabelledObject> objects;
  for (const auto& [id, e] : extents) {
    if (e.area < rules.min_object_area) continue;
    objects.push_back({id, e.area, {e.min_u, e.min_v, e.max_u - e.min_u + 1, e.max_v - e.min_v + 1}});
  }
  return objects;
}

FrameMatches matchBoxes(const Candidates& ranked, const cv::Mat1w& label, const DiscoveryRules& rules) {
  const std::vector<LabelledObject> objects = labelledObjects(label, rules);
  FrameMatches matches = emptyMatches(objects);
  const cv::Rect image({0, 0}, label.size());
  std::vector<double> overlaps(objects.size());
  for (std::size_t rank = 0; rank < counted(ranked, rules); ++rank) {
    const cv::Rect& box = ranked[rank].box;
    for (std::size_t i = 0; i < objects.size(); ++i) overlaps[i] = boxIou(objects[i].box, box);
    note(matches, overlaps, rules.min_iou, static_cast<int>(rank));
    const cv::Rect inside = box & image;
    int ignored = 0;
    for (int v = inside.y; v < inside.y + inside.height; ++v) {
      const std::uint16_t* row = label[v];
      for (int u = inside.x; u < inside.x + inside.width; ++u) ignored += row[u] >= rules.ignore_from ? 1 : 0;
    }
    matches.is_ignored.push_back(matches.is_right.back() == 0 && 2 * ignored > inside.area() ? 1 : 0);
  }
  return matches;
}

std::vector<double> maskOverlaps(const Candidate& candidate, const Perception& seen, const cv::Mat1w& label,
                                 const std::vector<LabelledObject>& objects) {
  std::vector<int> shared(objects.size(), 0);
  forEachMaskRun(candidate, seen, [&](int v, int begin, int end) {
    const std::uint16_t* row = label[v];
    for (int u = begin; u < end;) {
      const int first = u, id = row[u];
      while (u < end && row[u] == id) ++u;
      if (id == 0) continue;
      for (std::size_t i = 0; i < objects.size(); ++i) {
        if (objects[i].id == id) shared[i] += u - first;
      }
    }
  });
  std::vector<double> overlaps;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    overlaps.push_back(static_cast<double>(shared[i]) / (candidate.area + objects[i].area - shared[i]));
  }
  return overlaps;
}

FrameMatches matchMasks(const Candidates& ranked, const Perception& seen, const cv::Mat1w& label,
                        const DiscoveryRules& rules) {
  const std::vector<LabelledObject> objects = labelledObjects(label, rules);
  FrameMatches matches = emptyMatches(objects);
  for (std::size_t rank = 0; rank < counted(ranked, rules); ++rank) {
    note(matches, maskOverlaps(ranked[rank], seen, label, objects), rules.min_iou, static_cast<int>(rank));
    int ignored = 0;
    forEachMaskRun(ranked[rank], seen, [&](int v, int begin, int end) {
      for (int u = begin; u < end; ++u) ignored += label(v, u) >= rules.ignore_from ? 1 : 0;
    });
    matches.is_ignored.push_back(matches.is_right.back() == 0 && 2 * ignored > ranked[rank].area ? 1 : 0);
  }
  return matches;
}

void DiscoveryScore::add(const FrameMatches& frame) {
  if (!frame.object_ids.empty()) ++recall_sum_frames_;
  frames_.push_back(frame);
}

double DiscoveryScore::recall(int k) const {
  double sum = 0.0;
  for (const FrameMatches& frame : frames_) {
    if (frame.object_ids.empty()) continue;
    const auto found = std::count_if(frame.found_at.begin(), frame.found_at.end(),
                                     [k](int rank) { return rank != FrameMatches::kNever && rank < k; });
    sum += static_cast<double>(found) / static_cast<double>(frame.object_ids.size());
  }
  return recall_sum_frames_ > 0 ? sum / static_cast<double>(recall_sum_frames_) : 0.0;
}

double DiscoveryScore::precision(int k) const {
  double sum = 0.0;
  int frames = 0;
  for (const FrameMatches& frame : frames_) {
    const auto count = static_cast<std::ptrdiff_t>(
        std::min<std::size_t>(frame.is_right.size(), static_cast<std::size_t>(std::max(0, k))));
    const auto right = std::count(frame.is_right.begin(), frame.is_right.begin() + count, 1);
    const auto ignored = std::count(frame.is_ignored.begin(), frame.is_ignored.begin() + count, 1);
    if (count == ignored) continue;
    sum += static_cast<double>(right) / static_cast<double>(count - ignored);
    ++frames;
  }
  return frames > 0 ? sum / frames : 0.0;
}

double DiscoveryScore::fScore(int k) const {
  const double p = precision(k), r = recall(k);
  return p + r > 0.0 ? 2.0 * p * r / (p + r) : 0.0;
}

double DiscoveryScore::recallAuc() const {
  double sum = 0.0;
  for (int k = 1; k <= max_candidates_; ++k) sum += recall(k);
  return sum / max_candidates_;
}

double DiscoveryScore::globalRecall(int k) const {
  std::set<int> all, found;
  for (const FrameMatches& frame : frames_) {
    for (std::size_t i = 0; i < frame.object_ids.size(); ++i) {
      all.insert(frame.object_ids[i]);
      if (frame.found_at[i] != FrameMatches::kNever && frame.found_at[i] < k) found.insert(frame.object_ids[i]);
    }
  }
  return all.empty() ? 0.0 : static_cast<double>(found.size()) / static_cast<double>(all.size());
}

}  // namespace saccade
