#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/map/leaf_key.hpp"
#include "saccade/rendering/ior_view.hpp"

namespace saccade {

/// Collects the leaves that pixels of a view see: those to attend (paper, "3D IOR map update"), each once.
///
/// begin() with a view, then any number of add…() in any order, then keys(). Owns only its scratch, which it recycles.
/// Thread rule: one per thread.
class BackProjector {
 public:
  /// Forgets what was collected; the view must outlive the calls that follow.
  void begin(const IorView& view);

  /// Adds pixels first_u ... end_u - 1 of row v. Throws std::invalid_argument if they are not all in the image.
  void addRun(int v, int first_u, int end_u);
  /// Adds the pixels where `mask` is not 0. Throws std::invalid_argument unless it has the view's size.
  void addMask(const cv::Mat1b& mask);
  /// Adds the pixels of `box` whose segment `labels(v, u)` is chosen: `chosen[label]` not 0; labels outside of `chosen`
  /// are not. Throws std::invalid_argument unless `labels` has the view's size and `box` lies in it.
  void addSegments(const cv::Mat1i& labels, std::span<const std::uint8_t> chosen, const cv::Rect& box);

  /// The leaves collected since begin(), sorted, each once. Valid until the next begin().
  [[nodiscard]] const std::vector<LeafKey>& keys();

 private:
  void add(std::int32_t leaf_index) {
    if (leaf_index != IorView::kNoLeaf) seen_[static_cast<std::size_t>(leaf_index)] = 1;
  }
  void requireSize(const cv::Size& size) const;

  const IorView* view_ = nullptr;
  std::vector<std::uint8_t> seen_;  ///< by leaf index
  std::vector<LeafKey> keys_;
};

/// Keys of the leaves that the pixels of any of the masks see, sorted, each once. Masks as in BackProjector::addMask.
[[nodiscard]] std::vector<LeafKey> backProject(std::span<const cv::Mat1b> masks, const IorView& view);

}  // namespace saccade
