#include "saccade/attention/salient_blobs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "saccade/core/multiversion.hpp"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace saccade {
namespace {

constexpr int kWordBits = 64;

/// Marks the columns 1 ... columns - 2 whose value is at least that of all 8 neighbours.
SACCADE_MULTIVERSION void markCandidates(const float* above, const float* here, const float* below, int columns,
                                         std::uint8_t* marks) {
  for (int x = 1; x < columns - 1; ++x) {
    const float v = here[x];
    const bool row_above = !(above[x - 1] > v) & !(above[x] > v) & !(above[x + 1] > v);
    const bool row_below = !(below[x - 1] > v) & !(below[x] > v) & !(below[x + 1] > v);
    marks[x] = static_cast<std::uint8_t>((v > 0.0F) & row_above & row_below & !(here[x - 1] > v) & !(here[x + 1] > v));
  }
}

#ifdef __SSE2__

/// Bit i tells whether low <= values[i] <= high, for 64 values.
std::uint64_t rangeBits(const float* values, float low, float high) {
  const __m128 lowest = _mm_set1_ps(low), highest = _mm_set1_ps(high);
  const auto inRange = [&](const float* at) {
    const __m128 v = _mm_loadu_ps(at);
    return _mm_castps_si128(_mm_and_ps(_mm_cmpge_ps(v, lowest), _mm_cmple_ps(v, highest)));
  };
  std::uint64_t word = 0;
  for (int i = 0; i < kWordBits; i += 16) {
    const float* at = values + i;
    const __m128i first = _mm_packs_epi32(inRange(at), inRange(at + 4));
    const __m128i second = _mm_packs_epi32(inRange(at + 8), inRange(at + 12));
    const auto bits = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(first, second)));
    word |= static_cast<std::uint64_t>(bits) << i;
  }
  return word;
}

#else

std::uint64_t rangeBits(const float* values, float low, float high) {
  std::uint64_t word = 0;
  for (int i = 0; i < kWordBits; ++i) {
    word |= static_cast<std::uint64_t>(values[i] >= low && values[i] <= high) << i;
  }
  return word;
}

#endif

SACCADE_MULTIVERSION bool anyAbove(const float* values, int first, int end, float level) {
  int count = 0;
  for (int i = first; i < end; ++i) {
    count += values[i] > level ? 1 : 0;
  }
  return count > 0;
}

/// True if the pixel is higher than all its neighbours and has some.
bool isStrictMaximum(const cv::Mat1f& map, cv::Point at) {
  bool has_lower = false;
  for (int y = std::max(0, at.y - 1); y <= std::min(map.rows - 1, at.y + 1); ++y) {
    for (int x = std::max(0, at.x - 1); x <= std::min(map.cols - 1, at.x + 1); ++x) {
      if (map(y, x) >= map(at) && cv::Point(x, y) != at) {
        return false;
      }
      has_lower |= map(y, x) < map(at);
    }
  }
  return has_lower;
}

/// True if a neighbour has the same value and none a higher one.
bool isOnLevelGround(const cv::Mat1f& map, cv::Point at) {
  bool has_equal = false;
  for (int y = std::max(0, at.y - 1); y <= std::min(map.rows - 1, at.y + 1); ++y) {
    for (int x = std::max(0, at.x - 1); x <= std::min(map.cols - 1, at.x + 1); ++x) {
      if (map(y, x) > map(at)) {
        return false;
      }
      has_equal |= map(y, x) == map(at) && cv::Point(x, y) != at;
    }
  }
  return has_equal;
}

/// A pixel's plateau: the 8-connected pixels of its value. Appends it to `plateau`, marks it done; true if no neighbour
/// is higher and at least one is lower.
bool isHighestPlateau(const cv::Mat1f& map, cv::Point start, cv::Mat1b& done, std::vector<cv::Point>& plateau) {
  const float value = map(start);
  bool has_lower = false, has_higher = false;
  plateau.assign(1, start);
  done(start) = 1;
  for (std::size_t i = 0; i < plateau.size(); ++i) {
    const cv::Point p = plateau[i];
    for (int y = std::max(0, p.y - 1); y <= std::min(map.rows - 1, p.y + 1); ++y) {
      for (int x = std::max(0, p.x - 1); x <= std::min(map.cols - 1, p.x + 1); ++x) {
        const float other = map(y, x);
        has_higher |= other > value;
        has_lower |= other < value;
        if (other == value && done(y, x) == 0) {
          done(y, x) = 1;
          plateau.emplace_back(x, y);
        }
      }
    }
  }
  return has_lower && !has_higher;
}

}  // namespace

void BlobConfig::describe(ConfigVisitor& visitor) {
  visitor.numbers("thresholds", thresholds, {0.01, 0.99}, "", "shares of the seed's saliency that bound a blob");
  visitor.number("min_prominence", min_prominence, {0.0, 1.0}, "",
                 "height of a maximum over its highest pass to a higher place, less starts no blob");
  visitor.integer("min_area", min_area, {0, 1e9}, "px", "smaller blobs are left out");
  visitor.number("max_area_share", max_area_share, {0.0, 1.0}, "", "of the image, larger blobs are left out");
}

std::vector<SaliencyMaximum> findLocalMaxima(const cv::Mat1f& saliency) {
  std::vector<SaliencyMaximum> maxima;
  if (saliency.empty()) {
    return maxima;
  }
  cv::Mat1b done;  // made when the first plateau of more than a pixel is met: real maps seldom have one
  std::vector<cv::Point> plateau;
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(saliency.cols), 1);
  for (int y = 0; y < saliency.rows; ++y) {
    const bool inside = y > 0 && y < saliency.rows - 1;
    if (inside) {
      markCandidates(saliency[y - 1], saliency[y], saliency[y + 1], saliency.cols, marks.data());
    }
    for (int x = 0; x < saliency.cols; ++x) {
      const bool at_border = !inside || x == 0 || x == saliency.cols - 1;
      const cv::Point at(x, y);
      if ((!at_border && marks[static_cast<std::size_t>(x)] == 0) || !(saliency(at) > 0.0F)) {
        continue;
      }
      bool is_maximum = isStrictMaximum(saliency, at);
      if (!is_maximum && isOnLevelGround(saliency, at)) {
        if (done.empty()) {
          done = cv::Mat1b::zeros(saliency.size());
        }
        is_maximum = done(at) == 0 && isHighestPlateau(saliency, at, done, plateau);
      }
      if (is_maximum) {
        maxima.push_back({at, saliency(at)});
      }
    }
  }
  std::stable_sort(maxima.begin(), maxima.end(),
                   [](const SaliencyMaximum& a, const SaliencyMaximum& b) { return a.saliency > b.saliency; });
  return maxima;
}

BlobGrower::BlobGrower(BlobConfig config) : config_(std::move(config)) {
  requireValid(config_);
}

const std::vector<SalientBlob>& BlobGrower::grow(const cv::Mat1f& saliency,
                                                 const std::vector<SaliencyMaximum>& maxima) {
  const int words_per_row = (saliency.cols + kWordBits - 1) / kWordBits;
  const std::size_t words = static_cast<std::size_t>(words_per_row) * static_cast<std::size_t>(saliency.rows);
  if (words_per_row != words_per_row_ || words != words_.size()) {
    words_per_row_ = words_per_row;
    words_.assign(words, 0);
    word_stamps_.assign(words, 0);
    stamp_ = 0;
  }
  std::size_t count = 0;  // blobs_ keeps its elements, and they their runs, from call to call
  for (const SaliencyMaximum& maximum : maxima) {
    if (!cv::Rect(cv::Point(), saliency.size()).contains(maximum.position)) {
      throw std::invalid_argument("salient blobs: expected maxima inside " + std::to_string(saliency.cols) + " x " +
                                  std::to_string(saliency.rows) + ", found one at " +
                                  std::to_string(maximum.position.x) + ", " + std::to_string(maximum.position.y));
    }
    if (!isProminent(saliency, maximum)) {
      continue;
    }
    for (const double threshold : config_.thresholds) {
      if (count == blobs_.size()) {
        blobs_.emplace_back();
      }
      growOne(saliency, maximum, threshold, blobs_[count]);
      if (blobs_[count].area >= std::max(1, config_.min_area) && !isDuplicate(blobs_[count], count)) {
        ++count;
      }
    }
  }
  blobs_.resize(count);
  return blobs_;
}

/// Floods the surroundings down to `min_prominence` below the maximum, until something higher is met.
bool BlobGrower::isProminent(const cv::Mat1f& saliency, const SaliencyMaximum& maximum) {
  if (config_.min_prominence <= 0.0) {
    return true;
  }
  lowest_ = saliency(maximum.position) - static_cast<float>(config_.min_prominence);
  highest_ = std::numeric_limits<float>::infinity();
  stop_above_ = saliency(maximum.position);
  most_area_ = std::numeric_limits<int>::max();
  return flood(saliency, maximum.position, ground_);
}

void BlobGrower::growOne(const cv::Mat1f& saliency, const SaliencyMaximum& maximum, double threshold,
                         SalientBlob& blob) {
  blob.seed = maximum.position;
  blob.threshold = threshold;
  blob.seed_saliency = saliency(maximum.position);
  blob.area = 0;
  lowest_ = static_cast<float>(threshold * static_cast<double>(blob.seed_saliency));
  highest_ = stop_above_ = blob.seed_saliency;
  most_area_ = static_cast<int>(config_.max_area_share * static_cast<double>(saliency.total()));
  if (!flood(saliency, blob.seed, blob.runs)) {
    return;
  }
  std::sort(blob.runs.begin(), blob.runs.end(), [](const PixelRun& a, const PixelRun& b) {
    return a.row != b.row ? a.row < b.row : a.first_column < b.first_column;
  });
  int left = saliency.cols, right = 0;
  for (const PixelRun& run : blob.runs) {
    left = std::min(left, run.first_column);
    right = std::max(right, run.end_column);
  }
  blob.area = area_;
  blob.box = blob.runs.empty() ? cv::Rect()
                               : cv::Rect(left, blob.runs.front().row, right - left,
                                          blob.runs.back().row - blob.runs.front().row + 1);
}

/// Collects the runs of the region that holds the seed, in no order; false if it was given up: at a pixel above
/// `stop_above_`, or at more than `most_area_` pixels.
bool BlobGrower::flood(const cv::Mat1f& saliency, cv::Point seed, std::vector<PixelRun>& runs) {
  if (++stamp_ == 0) {  // after 2^32 floods old stamps would look new
    std::fill(word_stamps_.begin(), word_stamps_.end(), 0U);
    stamp_ = 1;
  }
  runs.clear();
  area_ = 0;
  bool goes_on = takeRunsTouching(saliency, seed.y, seed.x, seed.x + 1, runs);
  for (std::size_t next = 0; goes_on && next < runs.size(); ++next) {
    const PixelRun run = runs[next];
    const int first = std::max(0, run.first_column - 1), end = std::min(saliency.cols, run.end_column + 1);
    goes_on = (run.row == 0 || takeRunsTouching(saliency, run.row - 1, first, end, runs)) &&
              (run.row + 1 == saliency.rows || takeRunsTouching(saliency, run.row + 1, first, end, runs));
  }
  return goes_on;
}

/// The columns 64 * word ... of a row that the present blob may still take, one bit each.
std::uint64_t& BlobGrower::allowedWord(const cv::Mat1f& saliency, int row, int word) {
  const std::size_t index =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(words_per_row_) + static_cast<std::size_t>(word);
  if (word_stamps_[index] != stamp_) {
    word_stamps_[index] = stamp_;
    const int begin = word * kWordBits;
    if (begin + kWordBits <= saliency.cols) {
      words_[index] = rangeBits(saliency[row] + begin, lowest_, highest_);
    } else {
      float values[kWordBits];
      std::fill(std::copy(saliency[row] + begin, saliency[row] + saliency.cols, values), values + kWordBits,
                std::numeric_limits<float>::quiet_NaN());
      words_[index] = rangeBits(values, lowest_, highest_);
    }
  }
  return words_[index];
}

/// Takes all runs of a row that have a pixel in columns first ... end - 1, at their full length; false if the flood is
/// to be given up.
bool BlobGrower::takeRunsTouching(const cv::Mat1f& saliency, int row, int first, int end, std::vector<PixelRun>& runs) {
  int x = first;
  while (x < end) {
    const std::uint64_t rest = allowedWord(saliency, row, x / kWordBits) >> (x % kWordBits);
    if (rest == 0) {
      x = (x / kWordBits + 1) * kWordBits;
      continue;
    }
    x += std::countr_zero(rest);
    if (x >= end) {
      break;
    }
    int run_first = x, run_end = x + 1;
    while (run_first > 0) {  // towards lower columns
      const int last = run_first - 1;
      const int ones =
          std::countl_one(allowedWord(saliency, row, last / kWordBits) << (kWordBits - 1 - last % kWordBits));
      run_first -= ones;
      if (ones == 0 || run_first % kWordBits != 0) {
        break;
      }
    }
    while (run_end < saliency.cols) {  // towards higher columns
      const int ones = std::countr_one(allowedWord(saliency, row, run_end / kWordBits) >> (run_end % kWordBits));
      run_end += ones;
      if (ones == 0 || run_end % kWordBits != 0) {
        break;
      }
    }
    for (int word = run_first / kWordBits; word <= (run_end - 1) / kWordBits; ++word) {
      const int from = std::max(run_first - word * kWordBits, 0);
      const int to = std::min(run_end - word * kWordBits, kWordBits);
      const std::uint64_t taken = (~0ULL >> (kWordBits - (to - from))) << from;
      allowedWord(saliency, row, word) &= ~taken;
    }
    runs.push_back({row, run_first, run_end});
    area_ += run_end - run_first;
    if (area_ > most_area_ || (highest_ > stop_above_ && anyAbove(saliency[row], run_first, run_end, stop_above_))) {
      return false;
    }
    x = run_end + 1;
  }
  return true;
}

bool BlobGrower::isDuplicate(const SalientBlob& blob, std::size_t count) const {
  return std::any_of(blobs_.begin(), blobs_.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](const SalientBlob& other) {
                       return other.area == blob.area && other.box == blob.box && other.runs == blob.runs;
                     });
}

std::vector<SalientBlob> growSalientBlobs(const cv::Mat1f& saliency, const std::vector<SaliencyMaximum>& maxima,
                                          const BlobConfig& config) {
  return BlobGrower(config).grow(saliency, maxima);
}

}  // namespace saccade
