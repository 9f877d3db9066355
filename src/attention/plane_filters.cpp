#include "attention/plane_filters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kMaxRadius = 191;

/// Weights of the two nearest and the two next samples for a value half-way: the cubic through all four.
constexpr float kNear = 9.0F / 16.0F, kFar = -1.0F / 16.0F;

/// out[x] = in[0][x] * w[0] + sum over k of (in[k][x] + in[-k][x]) * w[k], for whole blocks.
SACCADE_MULTIVERSION void blendRows(const float* const* above, const float* const* below, const float* weights,
                                    int radius, int columns, float* out) {
  for (int x = 0; x < columns; x += kBlock) {
    float sum[kBlock];
    const float* center = above[0] + x;
    for (int i = 0; i < kBlock; ++i) {
      sum[i] = weights[0] * center[i];
    }
    for (int k = 1; k <= radius; ++k) {
      const float* a = above[k] + x;
      const float* b = below[k] + x;
      const float w = weights[k];
      for (int i = 0; i < kBlock; ++i) {
        sum[i] += w * (a[i] + b[i]);
      }
    }
    for (int i = 0; i < kBlock; ++i) {
      out[x + i] = sum[i];
    }
  }
}

/// The same along the row: `in` must be readable from -radius to columns + radius.
SACCADE_MULTIVERSION void blurRow(const float* in, const float* weights, int radius, int columns, float* out) {
  for (int x = 0; x < columns; x += kBlock) {
    float sum[kBlock];
    for (int i = 0; i < kBlock; ++i) {
      sum[i] = weights[0] * in[x + i];
    }
    for (int k = 1; k <= radius; ++k) {
      const float* a = in + x - k;
      const float* b = in + x + k;
      const float w = weights[k];
      for (int i = 0; i < kBlock; ++i) {
        sum[i] += w * (a[i] + b[i]);
      }
    }
    for (int i = 0; i < kBlock; ++i) {
      out[x + i] = sum[i];
    }
  }
}

SACCADE_MULTIVERSION void smoothRows(const float* above, const float* here, const float* below, int columns,
                                     float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] = 0.5F * here[x] + 0.25F * (above[x] + below[x]);
  }
}

/// Every other pixel of the row, smoothed; `in` must be readable from -1 to 2 * columns.
SACCADE_MULTIVERSION void smoothEvenPixels(const float* in, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] = 0.5F * in[2 * x] + 0.25F * (in[2 * x - 1] + in[2 * x + 1]);
  }
}

SACCADE_MULTIVERSION void mixFourRows(const std::array<const float*, 4>& rows, const std::array<float, 4>& weights,
                                      int columns, float* out) {
  const float* r0 = rows[0];
  const float* r1 = rows[1];
  const float* r2 = rows[2];
  const float* r3 = rows[3];
  const float w0 = weights[0], w1 = weights[1], w2 = weights[2], w3 = weights[3];
  for (int x = 0; x < columns; ++x) {
    out[x] = w0 * r0[x] + w1 * r1[x] + w2 * r2[x] + w3 * r3[x];
  }
}

/// Pairs of interpolated values; `in` must be readable from -2 to columns + 2.
SACCADE_MULTIVERSION void enlargePairs(const float* in, const std::array<float, 4>& even,
                                       const std::array<float, 4>& odd, int columns, float* out) {
  const float e0 = even[0], e1 = even[1], e2 = even[2], e3 = even[3];
  const float o0 = odd[0], o1 = odd[1], o2 = odd[2], o3 = odd[3];
  for (int x = 0; x < columns; ++x) {
    out[2 * x] = e0 * in[x - 2] + e1 * in[x - 1] + e2 * in[x] + e3 * in[x + 1];
    out[2 * x + 1] = o0 * in[x - 1] + o1 * in[x] + o2 * in[x + 1] + o3 * in[x + 2];
  }
}

/// Interpolated values, one for each pixel; `in` must be readable from -2 to columns + 1.
SACCADE_MULTIVERSION void shiftPixels(const float* in, const std::array<float, 4>& weights, int columns, float* out) {
  const float w0 = weights[0], w1 = weights[1], w2 = weights[2], w3 = weights[3];
  for (int x = 0; x < columns; ++x) {
    out[x] = w0 * in[x - 2] + w1 * in[x - 1] + w2 * in[x] + w3 * in[x + 1];
  }
}

SACCADE_MULTIVERSION void addRow(const float* in, int columns, float* sum) {
  for (int x = 0; x < columns; ++x) {
    sum[x] += in[x];
  }
}

SACCADE_MULTIVERSION void addAbsoluteDifferenceRow(const float* a, const float* b, int columns, float* sum) {
  for (int x = 0; x < columns; ++x) {
    sum[x] += std::abs(a[x] - b[x]);
  }
}

/// The same with a row of half as many pixels, interpolated between; `half` must be readable from -1 to columns + 2.
SACCADE_MULTIVERSION void addAbsoluteDifferenceFromHalf(const float* a, const float* half, int columns, float* sum) {
  for (int x = 0; x < columns; ++x) {
    const float between = kNear * (half[x] + half[x + 1]) + kFar * (half[x - 1] + half[x + 2]);
    sum[2 * x] += std::abs(a[2 * x] - half[x]);
    sum[2 * x + 1] += std::abs(a[2 * x + 1] - between);
  }
}

/// Weights of the samples at -1, 0, 1, 2 for a value at `t` in [0, 1): Keys' cubic with OpenCV's a = -0.75.
std::array<float, 4> cubicWeights(double t) {
  constexpr double kA = -0.75;
  const auto near = [](double d) { return ((kA + 2.0) * d - (kA + 3.0)) * d * d + 1.0; };
  const auto far = [](double d) { return ((kA * d - 5.0 * kA) * d + 8.0 * kA) * d - 4.0 * kA; };
  const double w0 = far(t + 1.0), w1 = near(t), w2 = near(1.0 - t);
  return {static_cast<float>(w0), static_cast<float>(w1), static_cast<float>(w2),
          static_cast<float>(1.0 - w0 - w1 - w2)};
}

}  // namespace

void Plane::resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  stride = (new_width + kBlock - 1) / kBlock * kBlock;
  values.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height), 0.0F);
}

std::vector<float> gaussianHalfKernel(double sigma) {
  if (sigma < 1e-3) {
    return {1.0F};
  }
  const int radius = std::max(1, static_cast<int>(std::ceil(3.0 * sigma)));
  std::vector<double> weights(static_cast<std::size_t>(radius) + 1);
  // A few rounds of correcting the sampled kernel's variance meet the wanted one.
  double sampled_sigma = sigma;
  double sum = 0.0;
  for (int round = 0; round < 8; ++round) {
    sum = 0.0;
    double variance = 0.0;
    for (int k = 0; k <= radius; ++k) {
      const double w = std::exp(-0.5 * k * k / (sampled_sigma * sampled_sigma));
      weights[static_cast<std::size_t>(k)] = w;
      sum += k == 0 ? w : 2.0 * w;
      variance += 2.0 * w * k * k;
    }
    variance /= sum;
    sampled_sigma *= std::sqrt(sigma * sigma / std::max(variance, 1e-6));
    sampled_sigma = std::clamp(sampled_sigma, 0.5 * sigma, 1.5 * sigma);
  }
  std::vector<float> half(weights.size());
  std::transform(weights.begin(), weights.end(), half.begin(), [&](double w) { return static_cast<float>(w / sum); });
  return half;
}

void PlaneFilter::blur(const Plane& in, const std::vector<float>& half_kernel, Plane& out) {
  for (int y = 0; y < in.height; ++y) {
    blurOneRow(in, half_kernel, y, out.row(y));
  }
}

void PlaneFilter::blurOneRow(const Plane& in, const std::vector<float>& half_kernel, int y, float* out) {
  const int radius = static_cast<int>(half_kernel.size()) - 1;
  if (radius > kMaxRadius) {
    throw std::invalid_argument("blur: expected a radius up to " + std::to_string(kMaxRadius) + ", found " +
                                std::to_string(radius));
  }
  float* middle = rowWithMargin(in.stride, radius + kBlock);
  std::array<const float*, kMaxRadius + 1> above, below;
  for (int k = 0; k <= radius; ++k) {
    above[static_cast<std::size_t>(k)] = in.row(std::max(0, y - k));
    below[static_cast<std::size_t>(k)] = in.row(std::min(in.height - 1, y + k));
  }
  blendRows(above.data(), below.data(), half_kernel.data(), radius, in.stride, middle);
  std::fill_n(middle - radius, radius, middle[0]);
  std::fill_n(middle + in.width, in.stride - in.width + radius, middle[in.width - 1]);
  blurRow(middle, half_kernel.data(), radius, in.stride, out);
}

float* PlaneFilter::rowWithMargin(int columns, int margin) {
  row_.resize(std::max(row_.size(), static_cast<std::size_t>(columns + 2 * margin)));
  return row_.data() + margin;
}

void PlaneFilter::halve(const Plane& in, Plane& out) {
  constexpr int kMargin = 1;
  float* middle = rowWithMargin(in.stride, kMargin);
  for (int y = 0; y < out.height; ++y) {
    smoothRows(in.row(std::max(0, 2 * y - 1)), in.row(2 * y), in.row(std::min(in.height - 1, 2 * y + 1)), in.width,
               middle);
    middle[-1] = middle[0];
    middle[in.width] = middle[in.width - 1];
    smoothEvenPixels(middle, out.width, out.row(y));
  }
}

/// Row `first` + t of `in`, with 2 more pixels at both ends: the row y of its samples interpolated.
float* PlaneFilter::interpolateRow(const Plane& in, const std::array<float, 4>& weights, int first) {
  constexpr int kMargin = 2;
  float* middle = rowWithMargin(in.stride, kMargin);
  std::array<const float*, 4> rows;
  for (int k = 0; k < 4; ++k) {
    rows[static_cast<std::size_t>(k)] = in.row(std::clamp(first + k, 0, in.height - 1));
  }
  mixFourRows(rows, weights, in.width, middle);
  std::fill_n(middle - kMargin, kMargin, middle[0]);
  std::fill_n(middle + in.width, kMargin, middle[in.width - 1]);
  return middle;
}

void PlaneFilter::enlargeOneRow(const Plane& in, double shift, int y, int columns, float* out) {
  // Output pixel 2i lies at i - shift of the input, between the samples i - 1 and i; pixel 2i + 1 lies at
  // i + 1/2 - shift, between the samples i and i + 1.
  const std::array<float, 4> even = cubicWeights(1.0 - shift);
  const std::array<float, 4> odd = cubicWeights(0.5 - shift);
  const float* middle = y % 2 == 0 ? interpolateRow(in, even, y / 2 - 2) : interpolateRow(in, odd, y / 2 - 1);
  enlargePairs(middle, even, odd, columns / 2, out);
  if (columns % 2 == 1) {
    shiftPixels(middle + columns / 2, even, 1, out + columns - 1);
  }
}

void PlaneFilter::addResampled(const Plane& in, double shift, Plane& sum) {
  added_row_.resize(std::max(added_row_.size(), static_cast<std::size_t>(sum.stride)));
  const bool same_size = in.width == sum.width && in.height == sum.height;
  const std::array<float, 4> weights = cubicWeights(1.0 - shift);
  for (int y = 0; y < sum.height; ++y) {
    if (same_size) {
      shiftPixels(interpolateRow(in, weights, y - 2), weights, sum.width, added_row_.data());
    } else {
      enlargeOneRow(in, shift, y, sum.width, added_row_.data());
    }
    addRow(added_row_.data(), sum.width, sum.row(y));
  }
}

void PlaneFilter::addContrast(const Plane& center, const Plane& surround, Plane& sum) {
  const bool same_size = surround.width == center.width && surround.height == center.height;
  for (int y = 0; y < center.height; ++y) {
    if (same_size) {
      addAbsoluteDifferenceRow(center.row(y), surround.row(y), center.width, sum.row(y));
    } else {
      addContrastFromHalf(center.row(y), surround, y, center.width, sum.row(y));
    }
  }
}

void PlaneFilter::addContrastFromHalf(const float* center, const Plane& surround, int y, int columns, float* sum) {
  const std::array<float, 4> weights =
      y % 2 == 0 ? std::array{0.0F, 1.0F, 0.0F, 0.0F} : std::array{kFar, kNear, kNear, kFar};
  const float* middle = interpolateRow(surround, weights, y / 2 - 1);
  addAbsoluteDifferenceFromHalf(center, middle, columns / 2, sum);
  if (columns % 2 == 1) {
    addAbsoluteDifferenceRow(center + columns - 1, middle + columns / 2, 1, sum + columns - 1);
  }
}

}  // namespace saccade
