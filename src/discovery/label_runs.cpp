#include "saccade/discovery/label_runs.hpp"

#include <bit>
#include <stdexcept>
#include <string>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace saccade {
namespace {

constexpr int kWordBits = 64;

#ifdef __SSE2__

/// Bit i tells whether labels i and i + 1 differ, for 64 of them and the one after.
std::uint64_t changes(const int* labels) {
  const auto areEqual = [&](int i) {
    return _mm_cmpeq_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(labels + i)),
                           _mm_loadu_si128(reinterpret_cast<const __m128i*>(labels + i + 1)));
  };
  std::uint64_t equal = 0;
  for (int i = 0; i < kWordBits; i += 16) {
    const __m128i first = _mm_packs_epi32(areEqual(i), areEqual(i + 4));
    const __m128i second = _mm_packs_epi32(areEqual(i + 8), areEqual(i + 12));
    equal |= static_cast<std::uint64_t>(static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(first, second))))
             << i;
  }
  return ~equal;
}

#else

std::uint64_t changes(const int* labels) {
  std::uint64_t word = 0;
  for (int i = 0; i < kWordBits; ++i) {
    word |= static_cast<std::uint64_t>(labels[i] != labels[i + 1] ? 1 : 0) << i;
  }
  return word;
}

#endif

/// Writes the runs of a row and returns their end.
LabelRun* findRuns(const int* labels, int width, LabelRun* out) {
  int u = 0;
  for (; u + kWordBits < width; u += kWordBits) {
    for (std::uint64_t word = changes(labels + u); word != 0; word &= word - 1) {
      const int last = u + std::countr_zero(word);
      *out++ = {last + 1, labels[last]};
    }
  }
  for (; u < width; ++u) {
    if (u + 1 == width || labels[u] != labels[u + 1]) *out++ = {u + 1, labels[u]};
  }
  return out;
}

}  // namespace

void LabelRuns::build(const Segmentation& segmentation) {
  const cv::Mat1i& labels = segmentation.labels;
  segments_ = segmentation.count;
  row_end_.clear();
  std::size_t used = 0;
  for (int v = 0; v < labels.rows; ++v) {
    const std::size_t most = used + static_cast<std::size_t>(labels.cols);
    if (runs_.size() < most) runs_.resize(2 * most);
    LabelRun* const begin = runs_.data() + used;
    LabelRun* const end = findRuns(labels[v], labels.cols, begin);
    for (const LabelRun* run = begin; run != end; ++run) {
      if (run->label >= segments_) {
        throw std::invalid_argument("LabelRuns: label " + std::to_string(run->label) + " where there are " +
                                    std::to_string(segments_) + " segments");
      }
    }
    used = static_cast<std::size_t>(end - runs_.data());
    row_end_.push_back(used);
  }
}

}  // namespace saccade
