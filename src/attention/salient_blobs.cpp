#include "saccade/attention/salient_blobs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "saccade/core/multiversion.hpp"

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

/// Bytes 1 where low <= value <= high.
SACCADE_MULTIVERSION void markRange(const float* values, float low, float high, std::uint8_t* marks) {
  for (int i = 0; i < kWordBits; ++i) {
    marks[i] = static_cast<std::uint8_t>((values[i] >= low) & (values[i] <= high));
  }
}

std::uint64_t packMarks(const std::uint8_t* marks) {
  std::uint64_t word = 0;
  for (int byte = 0; byte < kWordBits / 8; ++byte) {
    std::uint64_t eight = 0;
    for (int i = 7; i >= 0; --i) {
      eight = eight << 8 | marks[8 * byte + i];
    }
    // The product gathers the eight lowest bits of the bytes in the highest byte, first byte in the lowest bit.
    word |= (eight * 0x0102040810204080ULL >> 56) << (8 * byte);
  }
  return word;
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
  visitor.integer("min_area", min_area, {0, 1e9}, "px", "smaller blobs are left out");
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

void BlobGrower::growOne(const cv::Mat1f& saliency, const SaliencyMaximum& maximum, double threshold,
                         SalientBlob& blob) {
  blob.seed = maximum.position;
  blob.threshold = threshold;
  blob.seed_saliency = saliency(maximum.position);
  blob.runs.clear();
  blob.area = 0;
  highest_ = blob.seed_saliency;
  lowest_ = static_cast<float>(threshold * static_cast<double>(blob.seed_saliency));
  if (++stamp_ == 0) {  // after 2^32 blobs old stamps would look new
    std::fill(word_stamps_.begin(), word_stamps_.end(), 0U);
    stamp_ = 1;
  }
  stack_.clear();
  takeRunsTouching(saliency, blob.seed.y, blob.seed.x, blob.seed.x + 1, blob);
  while (!stack_.empty()) {
    const Segment run = stack_.back();
    stack_.pop_back();
    const int first = std::max(0, run.first - 1), end = std::min(saliency.cols, run.end + 1);
    if (run.row > 0) {
      takeRunsTouching(saliency, run.row - 1, first, end, blob);
    }
    if (run.row + 1 < saliency.rows) {
      takeRunsTouching(saliency, run.row + 1, first, end, blob);
    }
  }
  std::sort(blob.runs.begin(), blob.runs.end(), [](const PixelRun& a, const PixelRun& b) {
    return a.row != b.row ? a.row < b.row : a.first_column < b.first_column;
  });
  int left = saliency.cols, right = 0;
  for (const PixelRun& run : blob.runs) {
    left = std::min(left, run.first_column);
    right = std::max(right, run.end_column);
    blob.area += run.end_column - run.first_column;
  }
  blob.box = blob.runs.empty() ? cv::Rect()
                               : cv::Rect(left, blob.runs.front().row, right - left,
                                          blob.runs.back().row - blob.runs.front().row + 1);
}

/// The columns 64 * word ... of a row that the present blob may still take, one bit each.
std::uint64_t& BlobGrower::allowedWord(const cv::Mat1f& saliency, int row, int word) {
  const std::size_t index =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(words_per_row_) + static_cast<std::size_t>(word);
  if (word_stamps_[index] != stamp_) {
    word_stamps_[index] = stamp_;
    const int begin = word * kWordBits;
    std::uint8_t marks[kWordBits] = {};
    if (begin + kWordBits <= saliency.cols) {
      markRange(saliency[row] + begin, lowest_, highest_, marks);
    } else {
      for (int x = begin; x < saliency.cols; ++x) {
        const float v = saliency(row, x);
        marks[x - begin] = v >= lowest_ && v <= highest_ ? 1 : 0;
      }
    }
    words_[index] = packMarks(marks);
  }
  return words_[index];
}

/// Takes all runs of a row that have a pixel in columns first ... end - 1, at their full length.
void BlobGrower::takeRunsTouching(const cv::Mat1f& saliency, int row, int first, int end, SalientBlob& blob) {
  int x = first;
  while (x < end) {
    const std::uint64_t rest = allowedWord(saliency, row, x / kWordBits) >> (x % kWordBits);
    if (rest == 0) {
      x = (x / kWordBits + 1) * kWordBits;
      continue;
    }
    x += std::countr_zero(rest);
    if (x >= end) {
      return;
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
    blob.runs.push_back({row, run_first, run_end});
    stack_.push_back({row, run_first, run_end});
    x = run_end + 1;
  }
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
