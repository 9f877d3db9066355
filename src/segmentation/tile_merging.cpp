#include "segmentation/tile_merging.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <numeric>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace saccade {
namespace {

constexpr int kPixels = TileMerger::kWidth * TileMerger::kHeight;
constexpr int kDirectionBits = 2, kPixelBits = 11, kStepBits = 14;
constexpr int kStepShift = kDirectionBits + kPixelBits;
static_assert(kPixels == 1 << kPixelBits && ColorEdges::kSteps <= 1 << kStepBits && kStepShift + kStepBits <= 32);

constexpr std::array<int, kEdgeDirections> kOffsets{1, TileMerger::kWidth, TileMerger::kWidth + 1,
                                                    TileMerger::kWidth - 1};

std::uint16_t pixelOf(std::uint32_t edge) {
  return static_cast<std::uint16_t>((edge >> kDirectionBits) & (kPixels - 1));
}

std::uint16_t otherPixelOf(std::uint32_t edge) {
  return static_cast<std::uint16_t>(pixelOf(edge) + kOffsets[edge & (kEdgeDirections - 1)]);
}

static_assert(TileMerger::kWidth == 64 && TileMerger::kWidth <= ColorEdges::kPadding);

/// Bit i tells whether steps[i] < end, for 64 steps.
std::uint64_t bitsBelow(const std::uint16_t* steps, int end) {
  std::uint64_t bits = 0;
#ifdef __SSE2__
  const __m128i last = _mm_set1_epi16(static_cast<short>(end - 1));
  const auto isBelow = [&](int i) {
    const __m128i eight = _mm_loadu_si128(reinterpret_cast<const __m128i*>(steps + i));
    return _mm_cmpeq_epi16(_mm_subs_epu16(eight, last), _mm_setzero_si128());
  };
  for (int i = 0; i < 64; i += 16) {
    const auto sixteen = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(isBelow(i), isBelow(i + 8))));
    bits |= static_cast<std::uint64_t>(sixteen) << i;
  }
#else
  for (int i = 0; i < 64; ++i) {
    bits |= static_cast<std::uint64_t>(steps[i] < end ? 1 : 0) << i;
  }
#endif
  return bits;
}

}  // namespace

TileMerger::TileMerger(float k)
    : k_(k),
      distances_(ColorEdges::distances().data()),
      single_pixels_(kPixels, Component{0.0F, 1, ColorEdges::kNoEdge}),
      components_(kPixels),
      edges_(kEdgeDirections * kPixels),
      sorted_(kEdgeDirections * kPixels) {}

void TileMerger::merge(const ColorEdges& edges, const cv::Rect& tile, int end_step) {
  partition_.reset(kPixels);
  components_ = single_pixels_;
  limitAtBorder(edges, tile);
  gather(edges, tile, end_step);
  sort();
  mergeSorted();
}

/// Edges inside of a component, or between two that wait, change nothing. They are dropped chunk by chunk, without a
/// branch that the processor could guess wrongly.
void TileMerger::mergeSorted() {
  constexpr std::size_t kChunk = 32;
  std::array<PackedEdge, kChunk> open;
  for (std::size_t first = 0; first < edge_count_; first += kChunk) {
    const std::size_t end = std::min(edge_count_, first + kChunk);
    std::size_t count = 0;
    for (std::size_t i = first; i < end; ++i) {
      const PackedEdge edge = sorted_[i];
      const std::uint16_t a = partition_.label(pixelOf(edge)), b = partition_.label(otherPixelOf(edge));
      open[count] = edge;
      const auto step = static_cast<std::uint16_t>(edge >> kStepShift);
      count += (a != b) & (step < std::max(components_[a].limit, components_[b].limit)) ? 1 : 0;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!mergeAlong(open[i])) {
        return;
      }
    }
  }
}

/// Limits the border's pixels by their edges to pixels outside of the tile. Rows of steps hold no edges beyond the
/// image's columns.
void TileMerger::limitAtBorder(const ColorEdges& edges, const cv::Rect& tile) {
  const auto limit = [&](int u, int v, std::uint16_t first, std::uint16_t second, std::uint16_t third) {
    std::uint16_t& least = components_[static_cast<std::size_t>(v * kWidth + u)].limit;
    const auto step = [](std::uint16_t flagged) { return static_cast<std::uint16_t>(flagged & ColorEdges::kStepMask); };
    least = std::min(std::min(least, step(first)), std::min(step(second), step(third)));
  };
  const auto stepsAt = [&](int row, int direction) { return edges.steps(row, direction) + tile.x; };
  const int right = tile.width - 1, bottom = tile.height - 1;
  if (tile.y > 0) {
    const std::uint16_t *down = stepsAt(tile.y - 1, 1), *down_right = stepsAt(tile.y - 1, 2);
    const std::uint16_t* down_left = stepsAt(tile.y - 1, 3);
    for (int u = 0; u <= right; ++u) {
      limit(u, 0, down[u], down_right[u - 1], down_left[u + 1]);
    }
  }
  const int last_row = tile.y + bottom;
  const std::uint16_t *down = stepsAt(last_row, 1), *down_right = stepsAt(last_row, 2);
  const std::uint16_t* down_left = stepsAt(last_row, 3);
  for (int u = 0; u <= right; ++u) {
    limit(u, bottom, down[u], down_right[u], down_left[u]);
  }
  for (int v = 0; v <= bottom; ++v) {
    const int row = tile.y + v, row_above = std::max(0, row - 1);
    if (tile.x > 0) {
      limit(0, v, stepsAt(row, 0)[-1], row > 0 ? stepsAt(row_above, 2)[-1] : ColorEdges::kNoEdge, stepsAt(row, 3)[0]);
    }
    limit(right, v, stepsAt(row, 0)[right], stepsAt(row, 2)[right],
          row > 0 ? stepsAt(row_above, 3)[right + 1] : ColorEdges::kNoEdge);
  }
}

/// The edges inside the tile of less than `end_step` that are the last of no triangle, in row order.
void TileMerger::gather(const ColorEdges& edges, const cv::Rect& tile, int end_step) {
  PackedEdge* out = edges_.data();
  for (int v = 0; v < tile.height; ++v) {
    const int directions = v + 1 < tile.height ? kEdgeDirections : 1;
    for (int d = 0; d < directions; ++d) {
      const std::uint16_t* steps = edges.steps(tile.y + v, d) + tile.x;
      const int first = d == 3 ? 1 : 0, end = d == 0 || d == 2 ? tile.width - 1 : tile.width;
      const auto row = static_cast<PackedEdge>(v * kWidth << kDirectionBits | d);
      const std::uint64_t columns = (first < end ? ~0ULL >> (kWidth - (end - first)) : 0ULL) << first;
      for (std::uint64_t rest = bitsBelow(steps, end_step) & columns; rest != 0; rest &= rest - 1) {
        const auto u = static_cast<PackedEdge>(std::countr_zero(rest));
        *out++ = static_cast<PackedEdge>(steps[u]) << kStepShift | (row + (u << kDirectionBits));
      }
    }
  }
  edge_count_ = static_cast<std::size_t>(out - edges_.data());
}

/// Sorts the edges by rising step, equal ones in row order, by two digits.
void TileMerger::sort() {
  constexpr int kDigitBits = kStepBits / 2;
  constexpr std::size_t kDigits = 1 << kDigitBits;
  const auto low = [](PackedEdge edge) { return (edge >> kStepShift) & (kDigits - 1); };
  const auto high = [](PackedEdge edge) { return edge >> (kStepShift + kDigitBits); };
  std::array<std::uint32_t, kDigits> low_positions{}, high_positions{};
  for (std::size_t i = 0; i < edge_count_; ++i) {
    ++low_positions[low(edges_[i])];
    ++high_positions[high(edges_[i])];
  }
  std::exclusive_scan(low_positions.begin(), low_positions.end(), low_positions.begin(), 0U);
  std::exclusive_scan(high_positions.begin(), high_positions.end(), high_positions.begin(), 0U);
  for (std::size_t i = 0; i < edge_count_; ++i) {
    sorted_[low_positions[low(edges_[i])]++] = edges_[i];
  }
  for (std::size_t i = 0; i < edge_count_; ++i) {
    edges_[high_positions[high(sorted_[i])]++] = sorted_[i];
  }
  edges_.swap(sorted_);
}

/// False if the edge is refused.
bool TileMerger::mergeAlong(PackedEdge edge) {
  const std::uint16_t pixel = pixelOf(edge), other = otherPixelOf(edge);
  const std::uint16_t a = partition_.label(pixel), b = partition_.label(other);
  if (a == b) {
    return true;
  }
  Component &one = components_[a], &two = components_[b];
  const auto step = static_cast<std::uint16_t>(edge >> kStepShift);
  const std::uint16_t limit = std::min(one.limit, two.limit);
  if (step >= limit) {
    one.limit = std::min(one.limit, step);
    two.limit = std::min(two.limit, step);
    return true;
  }
  const float weight = distances_[step];
  if (!accepts(one.internal, one.area, weight, k_) || !accepts(two.internal, two.area, weight, k_)) {
    return false;
  }
  const std::array<std::uint16_t, 2> ends{pixel, other}, labels{a, b};  // chosen from without a branch
  const std::size_t larger = one.area < two.area ? 1 : 0;
  components_[labels[larger]] = {weight, static_cast<std::uint16_t>(one.area + two.area), limit};
  partition_.join(ends[1 - larger], ends[larger]);
  return true;
}

}  // namespace saccade
