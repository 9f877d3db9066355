#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/map/leaf_key.hpp"
#include "saccade/map/morton_code.hpp"
#include "saccade/rendering/ior_view.hpp"

namespace saccade {

/// Collects the leaves that the pixels of masks see: those to attend (paper, "3D IOR map update"), each once.
///
/// begin() with a view, then for each mask beginMask(), any number of add…() in any order, and keys(). Owns only its
/// scratch, which it recycles. Cost: one sort of the view's leaves, and the pixels of the masks.
/// Thread rule: one per thread.
class BackProjector {
 public:
  /// Forgets what was collected; the view must outlive the calls that follow. A first mask is begun.
  void begin(const IorView& view);
  /// Forgets what was collected for the mask before, of which allKeys() still knows.
  void beginMask();

  /// Adds pixels first_u ... end_u - 1 of row v. Throws std::invalid_argument if they are not all in the image.
  void addRun(int v, int first_u, int end_u);
  /// Adds the pixels where `mask` is not 0. Throws std::invalid_argument unless it has the view's size.
  void addMask(const cv::Mat1b& mask);
  /// Adds the pixels of `box` whose segment `labels(v, u)` is chosen: `chosen[label]` not 0; labels outside of `chosen`
  /// are not. Throws std::invalid_argument unless `labels` has the view's size and `box` lies in it.
  void addSegments(const cv::Mat1i& labels, std::span<const std::uint8_t> chosen, const cv::Rect& box);

  /// Puts the leaves collected since beginMask() into `keys`, in Morton order (that of the octree), each once.
  void keys(std::vector<LeafKey>& keys) const;
  /// The same for all masks since begin() together.
  void allKeys(std::vector<LeafKey>& keys) const;

 private:
  using Bits = std::vector<std::uint64_t>;

  void add(std::int32_t leaf_index) {
    if (leaf_index == IorView::kNoLeaf) return;
    const std::uint32_t place = place_[static_cast<std::size_t>(leaf_index)];
    of_mask_[place >> 6] |= std::uint64_t{1} << (place & 63);
  }
  void requireSize(const cv::Size& size) const;
  void appendKeys(std::size_t word, std::uint64_t bits, std::vector<LeafKey>& keys) const;

  const IorView* view_ = nullptr;
  std::vector<MortonCoded> order_, sorting_;  ///< leaves of the view in Morton order
  std::vector<std::uint32_t> place_;          ///< of each leaf in that order
  Bits of_mask_, of_masks_before_;            ///< by place
};

/// Keys of the leaves that the pixels of any of the masks see, in Morton order, each once. Masks as in
/// BackProjector::addMask.
[[nodiscard]] std::vector<LeafKey> backProject(std::span<const cv::Mat1b> masks, const IorView& view);

}  // namespace saccade
