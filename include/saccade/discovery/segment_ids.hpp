#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace saccade {

/// Rising ids of the segments that make up a candidate; never changed once made.
///
/// A frame has thousands of candidates: their ids lie one behind the other in a block that they share, so that none of
/// them takes memory of its own. The block lives as long as any of them.
class SegmentIds {
 public:
  using Block = std::vector<std::int32_t>;

  SegmentIds() = default;
  SegmentIds(std::initializer_list<std::int32_t> ids) : SegmentIds(Block(ids)) {}
  explicit SegmentIds(Block ids)
      : count_(static_cast<std::uint32_t>(ids.size())), block_(std::make_shared<const Block>(std::move(ids))) {}
  /// The `count` ids from `first` on in a block that may still grow at its end.
  SegmentIds(std::shared_ptr<const Block> block, std::size_t first, std::size_t count)
      : first_(static_cast<std::uint32_t>(first)),
        count_(static_cast<std::uint32_t>(count)),
        block_(std::move(block)) {}

  [[nodiscard]] std::size_t size() const { return block_ ? count_ : 0; }  // moved from: none
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// Good until the block grows.
  [[nodiscard]] const std::int32_t* begin() const { return block_ ? block_->data() + first_ : nullptr; }
  [[nodiscard]] const std::int32_t* end() const { return begin() + size(); }
  [[nodiscard]] std::int32_t operator[](std::size_t i) const { return begin()[i]; }

  friend bool operator==(const SegmentIds& a, const SegmentIds& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }
  friend auto operator<=>(const SegmentIds& a, const SegmentIds& b) {
    return std::lexicographical_compare_three_way(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  std::uint32_t first_ = 0, count_ = 0;
  std::shared_ptr<const Block> block_;
};

}  // namespace saccade
