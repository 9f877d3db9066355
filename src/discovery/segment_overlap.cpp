#include "saccade/discovery/segment_overlap.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace saccade {

void SegmentOverlap::build(const LabelRuns& first, const LabelRuns& second) {
  if (slots_.empty()) slots_.resize(4096);
  std::fill(slots_.begin(), slots_.end(), Slot{});
  used_slots_ = 0;
  const bool both = first.rows() > 0 && second.rows() > 0;
  if (both && first.rows() != second.rows()) {
    throw std::invalid_argument("SegmentOverlap: the segmentations have " + std::to_string(first.rows()) + " and " +
                                std::to_string(second.rows()) + " rows");
  }
  for (int v = 0; both && v < first.rows(); ++v) {
    forEachCommonRun(first.row(v), second.row(v), [&](int begin, int end, std::int32_t a, std::int32_t b) {
      if (a < 0 || b < 0) return;
      add(static_cast<std::uint64_t>(a + 1) << 32 | static_cast<std::uint64_t>(b + 1), end - begin);
    });
  }
  makeRows(first.segments(), true, first_begin_, of_first_);
  makeRows(second.segments(), false, second_begin_, of_second_);
}

void SegmentOverlap::add(std::uint64_t key, int pixels) {
  if (used_slots_ * 2 > slots_.size()) {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    used_slots_ = 0;
    for (const Slot& slot : old) {
      if (slot.key != 0) add(slot.key, slot.pixels);
    }
  }
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 40) & mask;
  while (slots_[i].key != 0 && slots_[i].key != key) i = (i + 1) & mask;
  if (slots_[i].key == 0) ++used_slots_;
  slots_[i].key = key;
  slots_[i].pixels += pixels;
}

void SegmentOverlap::makeRows(int count, bool of_first, std::vector<std::size_t>& begin,
                              std::vector<Share>& shares) const {
  const auto ids = [of_first](const Slot& slot) {
    const auto a = static_cast<std::size_t>(slot.key >> 32) - 1,
               b = static_cast<std::size_t>(slot.key & 0xFFFFFFFFU) - 1;
    return of_first ? std::pair{a, b} : std::pair{b, a};
  };
  begin.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const Slot& slot : slots_) {
    if (slot.key != 0) ++begin[ids(slot).first + 1];
  }
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  shares.resize(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (const Slot& slot : slots_) {
    if (slot.key == 0) continue;
    const auto [id, other] = ids(slot);
    shares[next[id]++] = {static_cast<std::int32_t>(other), slot.pixels};
  }
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
    std::sort(shares.begin() + static_cast<std::ptrdiff_t>(begin[i]),
              shares.begin() + static_cast<std::ptrdiff_t>(begin[i + 1]),
              [](const Share& a, const Share& b) { return a.other < b.other; });
  }
}

}  // namespace saccade
