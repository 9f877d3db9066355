#include "saccade/evaluation/discovery_metrics.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/coco_rle.hpp"
#include "saccade/discovery/ranker.hpp"

namespace saccade {
namespace {

FrameMatches emptyMatches(const std::vector<LabelledObject>& objects) {
  FrameMatches matches;
  for (const LabelledObject& object : objects) matches.object_ids.push_back(object.id);
  matches.found_at.assign(objects.size(), FrameMatches::kNever);
  matches.best_overlap.assign(objects.size(), 0.0);
  return matches;
}

std::size_t counted(std::size_t ranked, const DiscoveryRules& rules) {
  return std::min(ranked, static_cast<std::size_t>(std::max(0, rules.max_candidates)));
}

void note(FrameMatches& matches, const std::vector<double>& overlaps, double min_iou, int rank) {
  bool right = false;
  for (std::size_t i = 0; i < overlaps.size(); ++i) {
    matches.best_overlap[i] = std::max(matches.best_overlap[i], overlaps[i]);
    if (!(overlaps[i] > min_iou)) continue;
    right = true;
    if (matches.found_at[i] == FrameMatches::kNever) matches.found_at[i] = rank;
  }
  matches.is_right.push_back(right ? 1 : 0);
}

/// Pixels of a mask by the id below them.
using MaskCensus = std::map<int, int>;

double overlapWith(const LabelledObject& object, const MaskCensus& census, int mask_area) {
  const auto shared = census.find(object.id);
  if (shared == census.end()) return 0.0;
  return static_cast<double>(shared->second) / (mask_area + object.area - shared->second);
}

MaskCensus censusOf(const Candidate& candidate, const Perception& seen, const cv::Mat1w& label) {
  MaskCensus census;
  forEachMaskRun(candidate, seen, [&](int v, int begin, int end) {
    const std::uint16_t* row = label[v];
    for (int u = begin; u < end;) {
      const int first = u, id = row[u];
      while (u < end && row[u] == id) ++u;
      census[id] += u - first;
    }
  });
  return census;
}

/// `transposed`: the label image, whose rows are the columns that COCO's runs go along.
MaskCensus censusOf(const std::string& mask, const cv::Mat1w& transposed) {
  MaskCensus census;
  forEachCocoRun(mask, {transposed.rows, transposed.cols}, [&](int u, int begin, int end) {
    const std::uint16_t* column = transposed[u];
    for (int v = begin; v < end;) {
      const int first = v, id = column[v];
      while (v < end && column[v] == id) ++v;
      census[id] += v - first;
    }
  });
  return census;
}

void noteMask(FrameMatches& matches, const std::vector<LabelledObject>& objects, const MaskCensus& census,
              const DiscoveryRules& rules, int rank) {
  int area = 0, ignored = 0;
  for (const auto& [id, pixels] : census) {
    area += pixels;
    if (id >= rules.ignore_from) ignored += pixels;
  }
  std::vector<double> overlaps;
  overlaps.reserve(objects.size());
  for (const LabelledObject& object : objects) overlaps.push_back(overlapWith(object, census, area));
  note(matches, overlaps, rules.min_iou, rank);
  matches.is_ignored.push_back(matches.is_right.back() == 0 && 2 * ignored > area ? 1 : 0);
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
  std::vector<cv::Rect> boxes;
  for (const Candidate& candidate : ranked) boxes.push_back(candidate.box);
  return matchBoxes(boxes, label, rules);
}

FrameMatches matchBoxes(const std::vector<cv::Rect>& ranked, const cv::Mat1w& label, const DiscoveryRules& rules) {
  const std::vector<LabelledObject> objects = labelledObjects(label, rules);
  FrameMatches matches = emptyMatches(objects);
  const cv::Rect image({0, 0}, label.size());
  std::vector<double> overlaps(objects.size());
  for (std::size_t rank = 0; rank < counted(ranked.size(), rules); ++rank) {
    const cv::Rect& box = ranked[rank];
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
  const MaskCensus census = censusOf(candidate, seen, label);
  std::vector<double> overlaps;
  overlaps.reserve(objects.size());
  for (const LabelledObject& object : objects) overlaps.push_back(overlapWith(object, census, candidate.area));
  return overlaps;
}

FrameMatches matchMasks(const Candidates& ranked, const Perception& seen, const cv::Mat1w& label,
                        const DiscoveryRules& rules) {
  const std::vector<LabelledObject> objects = labelledObjects(label, rules);
  FrameMatches matches = emptyMatches(objects);
  for (std::size_t rank = 0; rank < counted(ranked.size(), rules); ++rank) {
    noteMask(matches, objects, censusOf(ranked[rank], seen, label), rules, static_cast<int>(rank));
  }
  return matches;
}

FrameMatches matchMasks(const std::vector<std::string>& ranked, const cv::Mat1w& label, const DiscoveryRules& rules) {
  const std::vector<LabelledObject> objects = labelledObjects(label, rules);
  FrameMatches matches = emptyMatches(objects);
  cv::Mat1w transposed;
  cv::transpose(label, transposed);
  for (std::size_t rank = 0; rank < counted(ranked.size(), rules); ++rank) {
    noteMask(matches, objects, censusOf(ranked[rank], transposed), rules, static_cast<int>(rank));
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

double DiscoveryScore::precisionAuc() const {
  double sum = 0.0;
  for (int k = 1; k <= max_candidates_; ++k) sum += precision(k);
  return sum / max_candidates_;
}

double DiscoveryScore::meanBestOverlap() const {
  double sum = 0.0;
  for (const FrameMatches& frame : frames_) {
    if (frame.object_ids.empty()) continue;
    sum += std::accumulate(frame.best_overlap.begin(), frame.best_overlap.end(), 0.0) /
           static_cast<double>(frame.best_overlap.size());
  }
  return recall_sum_frames_ > 0 ? sum / static_cast<double>(recall_sum_frames_) : 0.0;
}

double DiscoveryScore::globalRecall(int k) const {
  const std::vector<double> over_time = globalRecallOverTime(k);
  return over_time.empty() ? 0.0 : over_time.back();
}

std::vector<double> DiscoveryScore::globalRecallOverTime(int k) const {
  std::set<int> all, found;
  for (const FrameMatches& frame : frames_) all.insert(frame.object_ids.begin(), frame.object_ids.end());
  std::vector<double> over_time;
  for (const FrameMatches& frame : frames_) {
    for (std::size_t i = 0; i < frame.object_ids.size(); ++i) {
      if (frame.found_at[i] != FrameMatches::kNever && frame.found_at[i] < k) found.insert(frame.object_ids[i]);
    }
    over_time.push_back(all.empty() ? 0.0 : static_cast<double>(found.size()) / static_cast<double>(all.size()));
  }
  return over_time;
}

}  // namespace saccade
