#include "segmentation/color_edges.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <opencv2/core/hal/hal.hpp>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kChannels = 3;
constexpr int kStepShift = 23 - 9;
constexpr int kStepOfLeast = (127 - 10) << 9;

constexpr int kBlock = 32;   // floats in one block of the inner loops; rows are padded to it
constexpr int kMargin = 32;  // floats around a row, so that neighbours can be read beyond its ends

std::size_t padded(int width) {
  return static_cast<std::size_t>((width + kBlock - 1) / kBlock * kBlock);
}

std::size_t rowLength(int width) {
  return padded(width) + 2 * kMargin;
}

/// Bytes from one channel of a split row to the next: OpenCV writes channels that begin at equal remainders of a vector
/// past the cache, and to read them back from memory would take as long as all the rest of their work.
std::size_t splitStride(int width) {
  return padded(width) + 1;
}

SACCADE_MULTIVERSION void toFloats(const std::uint8_t* in, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] = static_cast<float>(in[x]);
  }
}

/// Convolves whole blocks of a row; `in` must be readable from -radius to the blocks' end + radius.
SACCADE_MULTIVERSION void smoothRow(const float* in, const float* weights, int radius, std::size_t columns,
                                    float* out) {
  for (std::size_t x = 0; x < columns; x += kBlock) {
    float sum[kBlock];
    for (int i = 0; i < kBlock; ++i) {
      sum[i] = weights[0] * in[x + static_cast<std::size_t>(i)];
    }
    for (int k = 1; k <= radius; ++k) {
      const float* before = in + x - k;
      const float* after = in + x + k;
      const float w = weights[k];
      for (int i = 0; i < kBlock; ++i) {
        sum[i] += w * (before[i] + after[i]);
      }
    }
    for (int i = 0; i < kBlock; ++i) {
      out[x + static_cast<std::size_t>(i)] = sum[i];
    }
  }
}

SACCADE_MULTIVERSION void scaleRow(const float* in, float weight, std::size_t columns, float* out) {
  for (std::size_t x = 0; x < columns; ++x) {
    out[x] = weight * in[x];
  }
}

SACCADE_MULTIVERSION void addRows(const float* above, const float* below, float weight, std::size_t columns,
                                  float* out) {
  for (std::size_t x = 0; x < columns; ++x) {
    out[x] += weight * (above[x] + below[x]);
  }
}

/// Steps of the edges from each pixel of the row `here` to the one at `offset` in the row `there`.
SACCADE_MULTIVERSION void weighRow(const float* here, const float* there, std::size_t length, int offset, int columns,
                                   std::uint16_t* steps) {
  const float *b0 = here, *g0 = here + length, *r0 = here + 2 * length;
  const float *b1 = there + offset, *g1 = b1 + length, *r1 = g1 + length;
  for (int x = 0; x < columns; ++x) {
    const float b = b0[x] - b1[x], g = g0[x] - g1[x], r = r0[x] - r1[x];
    const int step = (std::bit_cast<int>(b * b + g * g + r * r) >> kStepShift) - kStepOfLeast;
    steps[x] = static_cast<std::uint16_t>(step < 0 ? 0 : step);
  }
}

/// Flags the last edge of each triangle in `columns` blocks of 2 x 2 pixels, p and q above r and s. The arguments are
/// the steps of the edges p-q, r-s, p-r, p-s and q-r; the edge q-s is p-r of the next block. Whole vector blocks.
SACCADE_MULTIVERSION void markHeaviest(std::uint16_t* pq, std::uint16_t* rs, std::uint16_t* pr, std::uint16_t* ps,
                                       std::uint16_t* qr, int columns) {
  constexpr int kN = kBlock;
  for (int x = 0; x < columns; x += kN) {
    std::uint16_t a[kN], b[kN], c[kN], d[kN], e[kN], f[kN];  // in the order of edges of equal step, but for c and d
    for (int i = 0; i < kN; ++i) {
      a[i] = pq[x + i] & ColorEdges::kStepMask;
      b[i] = pr[x + i] & ColorEdges::kStepMask;
      c[i] = pr[x + i + 1] & ColorEdges::kStepMask;
      d[i] = ps[x + i] & ColorEdges::kStepMask;
      e[i] = qr[x + i] & ColorEdges::kStepMask;
      f[i] = rs[x + i] & ColorEdges::kStepMask;
    }
    std::uint16_t last_a[kN], last_b[kN], last_c[kN], last_d[kN], last_e[kN], last_f[kN];
    for (int i = 0; i < kN; ++i) {  // triangles: pq, qs, ps; pr, ps, rs; pq, pr, qr; qs, qr, rs
      const bool in_a = ((a[i] > c[i]) & (a[i] > d[i])) | ((a[i] > b[i]) & (a[i] > e[i]));
      const bool in_b = ((b[i] > d[i]) & (b[i] > f[i])) | ((b[i] >= a[i]) & (b[i] > e[i]));
      const bool in_c = ((c[i] >= a[i]) & (c[i] > d[i])) | ((c[i] > e[i]) & (c[i] > f[i]));
      const bool in_d = ((d[i] >= a[i]) & (d[i] >= c[i])) | ((d[i] >= b[i]) & (d[i] > f[i]));
      const bool in_e = ((e[i] >= a[i]) & (e[i] >= b[i])) | ((e[i] >= c[i]) & (e[i] > f[i]));
      const bool in_f = ((f[i] >= b[i]) & (f[i] >= d[i])) | ((f[i] >= c[i]) & (f[i] >= e[i]));
      last_a[i] = in_a ? ColorEdges::kHeaviest : std::uint16_t{0};
      last_b[i] = in_b ? ColorEdges::kHeaviest : std::uint16_t{0};
      last_c[i] = in_c ? ColorEdges::kHeaviest : std::uint16_t{0};
      last_d[i] = in_d ? ColorEdges::kHeaviest : std::uint16_t{0};
      last_e[i] = in_e ? ColorEdges::kHeaviest : std::uint16_t{0};
      last_f[i] = in_f ? ColorEdges::kHeaviest : std::uint16_t{0};
    }
    for (int i = 0; i < kN; ++i) {
      pq[x + i] |= last_a[i];
      rs[x + i] |= last_f[i];
      ps[x + i] |= last_d[i];
      qr[x + i] |= last_e[i];
      pr[x + i] |= last_b[i];
    }
    for (int i = 0; i < kN; ++i) {
      pr[x + i + 1] |= last_c[i];
    }
  }
}

std::vector<float> gaussianHalfKernel(double sigma) {
  // Cut like the authors' program: at 4 sigma, rounded up.
  const int radius = sigma > 0.0 ? static_cast<int>(std::ceil(4.0 * sigma)) : 0;
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = 0; k <= radius; ++k) {
    weights.push_back(k == 0 ? 1.0 : std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += k == 0 ? 1.0 : 2.0 * weights.back();
  }
  std::vector<float> half(weights.size());
  std::transform(weights.begin(), weights.end(), half.begin(), [&](double w) { return static_cast<float>(w / sum); });
  return half;
}

}  // namespace

ColorEdges::ColorEdges(double sigma) : half_kernel_(gaussianHalfKernel(sigma)), counts_(kSteps) {}

const std::vector<float>& ColorEdges::distances() {
  static const std::vector<float> table = [] {
    std::vector<float> distances(kSteps, 0.0F);
    for (std::uint32_t step = 1; step < kSteps; ++step) {
      const std::uint32_t bits = (step + static_cast<std::uint32_t>(kStepOfLeast)) << kStepShift;
      distances[step] = std::sqrt(std::bit_cast<float>(bits | 1U << (kStepShift - 1)));
    }
    return distances;
  }();
  return table;
}

std::array<int, 2> ColorEdges::columns(int row, int direction) const {
  if (direction > 0 && row + 1 == size_.height) {
    return {0, 0};
  }
  return {direction == 3 ? 1 : 0, direction == 0 || direction == 2 ? size_.width - 1 : size_.width};
}

void ColorEdges::resize(cv::Size size) {
  if (size == size_) {
    return;
  }
  size_ = size;
  const std::size_t length = rowLength(size.width);
  split_.assign(kChannels * splitStride(size.width), 0);
  raw_row_.assign(length, 0.0F);
  row_blurs_.assign((2 * half_kernel_.size() - 1) * kChannels * length, 0.0F);
  smooth_.assign(2 * kChannels * length, 0.0F);
  stride_ = static_cast<std::ptrdiff_t>(padded(size.width)) + kPadding;
  steps_.assign(kEdgeDirections * static_cast<std::size_t>(stride_ * size.height), kNoEdge);
}

/// Smooths the image row by row and weighs the edges between a row and the next as soon as both are there.
void ColorEdges::weigh(const cv::Mat3b& bgr) {
  resize(bgr.size());
  const std::size_t length = rowLength(size_.width);
  const int radius = static_cast<int>(half_kernel_.size()) - 1;
  for (int y = 0; y < std::min(radius, size_.height); ++y) {
    smoothAlongRow(bgr, y);
  }
  const auto smoothRowAt = [&](int y) {
    return smooth_.data() + static_cast<std::size_t>(y % 2) * kChannels * length + kMargin;
  };
  for (int y = 0; y < size_.height; ++y) {
    if (y + radius < size_.height) {
      smoothAlongRow(bgr, y + radius);
    }
    smoothAcrossRows(y);
    const float *here = smoothRowAt(y), *above = smoothRowAt(y - 1 + 2);
    weighRow(here, here, length, 1, size_.width - 1, stepsToWrite(y, 0));
    if (y > 0) {
      weighRow(above, here, length, 0, size_.width, stepsToWrite(y - 1, 1));
      weighRow(above, here, length, 1, size_.width - 1, stepsToWrite(y - 1, 2));
      weighRow(above + 1, here + 1, length, -1, size_.width - 1, stepsToWrite(y - 1, 3) + 1);
      markHeaviestBelow(y - 1);
    }
  }
}

/// Flags the last edges of the triangles between a row and the next.
void ColorEdges::markHeaviestBelow(int row) {
  markHeaviest(stepsToWrite(row, 0), stepsToWrite(row + 1, 0), stepsToWrite(row, 1), stepsToWrite(row, 2),
               stepsToWrite(row, 3) + 1, size_.width);
}

void ColorEdges::smoothAlongRow(const cv::Mat3b& bgr, int row) {
  const std::size_t length = rowLength(size_.width), width = static_cast<std::size_t>(size_.width);
  const std::size_t stride = splitStride(size_.width);
  const int radius = static_cast<int>(half_kernel_.size()) - 1;
  std::array<std::uint8_t*, kChannels> split{split_.data(), split_.data() + stride, split_.data() + 2 * stride};
  cv::hal::split8u(bgr.ptr(row), split.data(), size_.width, kChannels);
  float* out = row_blurs_.data() + static_cast<std::size_t>(row % (2 * radius + 1)) * kChannels * length + kMargin;
  float* raw = raw_row_.data() + kMargin;
  for (std::size_t c = 0; c < kChannels; ++c) {
    toFloats(split[c], size_.width, raw);
    std::fill_n(raw - radius, radius, raw[0]);
    std::fill_n(raw + width, radius, raw[width - 1]);
    smoothRow(raw, half_kernel_.data(), radius, padded(size_.width), out + c * length);
  }
}

void ColorEdges::smoothAcrossRows(int row) {
  const std::size_t length = rowLength(size_.width);
  const int radius = static_cast<int>(half_kernel_.size()) - 1;
  const auto blurred = [&](int y) {
    const int inside = std::clamp(y, 0, size_.height - 1);
    return row_blurs_.data() + static_cast<std::size_t>(inside % (2 * radius + 1)) * kChannels * length;
  };
  // All three channels and their margins are one run of floats.
  const std::size_t columns = kChannels * length;
  float* out = smooth_.data() + static_cast<std::size_t>(row % 2) * kChannels * length;
  scaleRow(blurred(row), half_kernel_[0], columns, out);
  for (int k = 1; k <= radius; ++k) {
    addRows(blurred(row - k), blurred(row + k), half_kernel_[static_cast<std::size_t>(k)], columns, out);
  }
}

/// Counts the edges of every 8th row by step; returns their number.
std::size_t ColorEdges::countSteps() {
  std::fill(counts_.begin(), counts_.end(), 0U);
  std::size_t total = 0;
  for (int y = 0; y < size_.height; y += 8) {
    for (int d = 0; d < kEdgeDirections; ++d) {
      const auto [first, end] = columns(y, d);
      const std::uint16_t* row = steps(y, d);
      for (int x = first; x < end; ++x) {
        ++counts_[row[x] & kStepMask];
      }
      total += static_cast<std::size_t>(std::max(0, end - first));
    }
  }
  return total;
}

}  // namespace saccade
