#include "saccade/rendering/back_project.hpp"

#include <bit>
#include <stdexcept>
#include <string>

namespace saccade {

namespace {

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace

void BackProjector::begin(const IorView& view) {
  view_ = &view;
  order_.clear();
  std::uint64_t differing = 0;
  for (const VisibleLeaf& leaf : view.leaves) {
    order_.push_back({mortonCode(leaf.key), static_cast<std::uint32_t>(order_.size())});
    differing |= order_.back().code ^ order_.front().code;
  }
  sortByMortonCode(order_, sorting_, static_cast<int>(std::bit_width(differing)));
  place_.resize(order_.size());
  for (std::size_t place = 0; place < order_.size(); ++place) {
    place_[order_[place].index] = static_cast<std::uint32_t>(place);
  }
  for (Bits* bits : {&of_mask_, &of_masks_before_}) bits->assign((order_.size() + 63) / 64, 0);
}

void BackProjector::beginMask() {
  for (std::size_t i = 0; i < of_mask_.size(); ++i) {
    of_masks_before_[i] |= of_mask_[i];
    of_mask_[i] = 0;
  }
}

void BackProjector::requireSize(const cv::Size& size) const {
  if (view_ == nullptr) throw std::invalid_argument("BackProjector: begin() with a view comes first");
  if (size != view_->leaf_index.size()) {
    throw std::invalid_argument("BackProjector: the view has " + sizeText(view_->leaf_index.size()) +
                                " pixels, the mask " + sizeText(size));
  }
}

void BackProjector::addRun(int v, int first_u, int end_u) {
  const cv::Size size = view_ == nullptr ? cv::Size() : view_->leaf_index.size();
  if (v < 0 || v >= size.height || first_u < 0 || first_u > end_u || end_u > size.width) {
    throw std::invalid_argument("BackProjector: run " + std::to_string(first_u) + "..." + std::to_string(end_u) +
                                " of row " + std::to_string(v) + " is not in an image of " + sizeText(size));
  }
  const std::int32_t* row = view_->leaf_index[v];
  for (int u = first_u; u < end_u; ++u) add(row[u]);
}

void BackProjector::addMask(const cv::Mat1b& mask) {
  requireSize(mask.size());
  for (int v = 0; v < mask.rows; ++v) {
    const std::uint8_t* in_mask = mask[v];
    const std::int32_t* row = view_->leaf_index[v];
    for (int u = 0; u < mask.cols; ++u) {
      if (in_mask[u] != 0) add(row[u]);
    }
  }
}

void BackProjector::addSegments(const cv::Mat1i& labels, std::span<const std::uint8_t> chosen, const cv::Rect& box) {
  requireSize(labels.size());
  if ((box & cv::Rect({0, 0}, labels.size())) != box) {
    throw std::invalid_argument("BackProjector: the box ends at " + sizeText({box.x + box.width, box.y + box.height}) +
                                ", the image at " + sizeText(labels.size()));
  }
  for (int v = box.y; v < box.y + box.height; ++v) {
    const std::int32_t* label = labels[v];
    const std::int32_t* row = view_->leaf_index[v];
    for (int u = box.x; u < box.x + box.width; ++u) {
      const auto segment = static_cast<std::size_t>(label[u]);  // a negative label becomes too large
      if (segment < chosen.size() && chosen[segment] != 0) add(row[u]);
    }
  }
}

void BackProjector::keys(std::vector<LeafKey>& keys) const {
  keys.clear();
  for (std::size_t i = 0; i < of_mask_.size(); ++i) appendKeys(i, of_mask_[i], keys);
}

void BackProjector::allKeys(std::vector<LeafKey>& keys) const {
  keys.clear();
  for (std::size_t i = 0; i < of_mask_.size(); ++i) appendKeys(i, of_mask_[i] | of_masks_before_[i], keys);
}

void BackProjector::appendKeys(std::size_t word, std::uint64_t bits, std::vector<LeafKey>& keys) const {
  for (; bits != 0; bits &= bits - 1) {
    const std::size_t place = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
    keys.push_back(view_->leaves[order_[place].index].key);
  }
}

std::vector<LeafKey> backProject(std::span<const cv::Mat1b> masks, const IorView& view) {
  BackProjector projector;
  projector.begin(view);
  for (const cv::Mat1b& mask : masks) projector.addMask(mask);
  std::vector<LeafKey> keys;
  projector.keys(keys);
  return keys;
}

}  // namespace saccade
