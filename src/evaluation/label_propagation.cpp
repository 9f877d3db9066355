#include "saccade/evaluation/label_propagation.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include "saccade/rendering/renderer.hpp"

namespace saccade {
namespace {

using LeafLabels = std::unordered_map<LeafKey, std::uint16_t>;

/// The ids that one labelled frame gives to the leaves it sees.
LeafLabels labelLeaves(const IorView& view, const cv::Mat1w& label, const DistortedPixels& pixels) {
  // Which leaf a pixel of the input shows: the labels are drawn there.
  cv::Mat1i shown;
  pixels.distort(cv::Mat1i(view.leaf_index), shown, IorView::kNoLeaf);
  std::vector<std::map<std::uint16_t, int>> votes(view.leaves.size());
  for (int v = 0; v < shown.rows; ++v) {
    for (int u = 0; u < shown.cols; ++u) {
      if (shown(v, u) != IorView::kNoLeaf) ++votes[static_cast<std::size_t>(shown(v, u))][label(v, u)];
    }
  }
  LeafLabels labels;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i].empty()) continue;
    const auto most = std::max_element(votes[i].begin(), votes[i].end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    labels.emplace(view.leaves[i].key, most->first);
  }
  return labels;
}

struct LabelledFrame {
  std::size_t position = 0;  ///< in the list of all frames
  LeafLabels leaves;
};

/// The label image of a view: of each leaf, what `nearest` says of it, else what `other` says.
cv::Mat1w paint(const IorView& view, const LabelledFrame& nearest, const LabelledFrame* other) {
  std::vector<std::uint16_t> ids(view.leaves.size(), 0);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const LeafKey& key = view.leaves[i].key;
    if (const auto found = nearest.leaves.find(key); found != nearest.leaves.end()) {
      ids[i] = found->second;
    } else if (other != nullptr) {
      if (const auto known = other->leaves.find(key); known != other->leaves.end()) ids[i] = known->second;
    }
  }
  cv::Mat1w label(view.leaf_index.size(), std::uint16_t{0});
  for (int v = 0; v < label.rows; ++v) {
    for (int u = 0; u < label.cols; ++u) {
      const std::int32_t leaf = view.leaf_index(v, u);
      if (leaf != IorView::kNoLeaf) label(v, u) = ids[static_cast<std::size_t>(leaf)];
    }
  }
  return label;
}

struct Overlap {
  std::int64_t true_area = 0, area = 0, shared = 0;
};

}  // namespace

LabelFrames propagateLabels(const IorMap& map, const PinholeCamera& camera, const DistortedPixels& pixels,
                            const std::vector<PosedFrame>& frames, const LabelFrames& given) {
  Renderer renderer;
  std::vector<LabelledFrame> labelled;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::optional<cv::Mat1w> label = given.find(frames[i].name);
    if (!label) continue;
    labelled.push_back({i, labelLeaves(renderer.renderIor(map.view(), camera, frames[i].T_WC), *label, pixels)});
  }
  if (labelled.empty()) {
    throw std::invalid_argument("propagateLabels: expected a label for at least one frame with a pose, found none");
  }
  LabelFrames all;
  std::size_t after = 0;  // the first labelled frame that is not before frame i
  cv::Mat1w distorted;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (const std::optional<cv::Mat1w> label = given.find(frames[i].name)) {
      all.add(frames[i].name, *label);
      continue;
    }
    while (after < labelled.size() && labelled[after].position < i) ++after;
    const LabelledFrame* next = after < labelled.size() ? &labelled[after] : nullptr;
    const LabelledFrame* previous = after > 0 ? &labelled[after - 1] : nullptr;
    if (previous == nullptr || (next != nullptr && next->position - i < i - previous->position)) {
      std::swap(previous, next);
    }
    const IorView& view = renderer.renderIor(map.view(), camera, frames[i].T_WC);
    pixels.distort(paint(view, *previous, next), distorted, std::uint16_t{0});
    all.add(frames[i].name, distorted);
  }
  return all;
}

LabelAgreement compareLabels(const LabelFrames& labels, const LabelFrames& truth, const LabelFrames& skip,
                             const std::vector<PosedFrame>& frames, int min_area) {
  LabelAgreement agreement;
  for (const PosedFrame& frame : frames) {
    const std::optional<cv::Mat1w> label = labels.find(frame.name), expected = truth.find(frame.name);
    if (!label || !expected || skip.has(frame.name)) continue;
    std::map<int, Overlap> overlaps;
    for (int v = 0; v < label->rows; ++v) {
      for (int u = 0; u < label->cols; ++u) {
        const int a = (*label)(v, u), b = (*expected)(v, u);
        ++overlaps[a].area;
        ++overlaps[b].true_area;
        if (a == b) ++overlaps[a].shared;
      }
    }
    for (const auto& [id, overlap] : overlaps) {
      if (id == 0 || overlap.true_area < min_area) continue;
      agreement.mean_iou +=
          static_cast<double>(overlap.shared) / static_cast<double>(overlap.area + overlap.true_area - overlap.shared);
      ++agreement.objects;
    }
  }
  if (agreement.objects > 0) agreement.mean_iou /= agreement.objects;
  return agreement;
}

}  // namespace saccade
