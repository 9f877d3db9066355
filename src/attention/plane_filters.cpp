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

SACCADE_MULTIVERSION void halveRows(const float* upper, const float* lower, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] = 0.25F * ((upper[2 * x] + upper[2 * x + 1]) + (lower[2 * x] + lower[2 * x + 1]));
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

/// Adds pairs of interpolated values; `in` must be readable from -2 to columns + 2.
SACCADE_MULTIVERSION void addEnlargedRow(const float* in, const std::array<float, 4>& even,
                                         const std::array<float, 4>& odd, int columns, float* out) {
  const float e0 = even[0], e1 = even[1], e2 = even[2], e3 = even[3];
  const float o0 = odd[0], o1 = odd[1], o2 = odd[2], o3 = odd[3];
  for (int x = 0; x < columns; ++x) {
    out[2 * x] += e0 * in[x - 2] + e1 * in[x - 1] + e2 * in[x] + e3 * in[x + 1];
    out[2 * x + 1] += o0 * in[x - 1] + o1 * in[x] + o2 * in[x + 1] + o3 * in[x + 2];
  }
}

SACCADE_MULTIVERSION void addAbsoluteDifferenceRow(const float* a, const float* b, std::size_t count, float* sum) {
  for (std::size_t i = 0; i < count; ++i) {
    sum[i] += std::abs(a[i] - b[i]);
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
  const int radius = static_cast<int>(half_kernel.size()) - 1;
  if (radius > kMaxRadius) {
    throw std::invalid_argument("blur: expected a radius up to " + std::to_string(kMaxRadius) + ", found " +
                                std::to_string(radius));
  }
  const int margin = radius + kBlock;
  row_.resize(std::max(row_.size(), static_cast<std::size_t>(in.stride + 2 * margin)));
  float* middle = row_.data() + margin;
  std::array<const float*, kMaxRadius + 1> above{}, below{};
  for (int y = 0; y < in.height; ++y) {
    for (int k = 0; k <= radius; ++k) {
      above[static_cast<std::size_t>(k)] = in.row(std::max(0, y - k));
      below[static_cast<std::size_t>(k)] = in.row(std::min(in.height - 1, y + k));
    }
    blendRows(above.data(), below.data(), half_kernel.data(), radius, in.stride, middle);
    std::fill_n(middle - radius, radius, middle[0]);
    std::fill_n(middle + in.width, in.stride - in.width + radius, middle[in.width - 1]);
    blurRow(middle, half_kernel.data(), radius, in.stride, out.row(y));
  }
}

void PlaneFilter::halve(const Plane& in, Plane& out) {
  for (int y = 0; y < out.height; ++y) {
    const float* upper = in.row(2 * y);
    const float* lower = in.row(std::min(in.height - 1, 2 * y + 1));
    halveRows(upper, lower, in.width / 2, out.row(y));
    if (in.width % 2 == 1) {
      out.row(y)[out.width - 1] = 0.5F * (upper[in.width - 1] + lower[in.width - 1]);
    }
  }
}

void PlaneFilter::addEnlarged(const Plane& in, double shift, Plane& out) {
  // Output pixel 2i lies at i - 1/4 - shift of the input, pixel 2i + 1 at i + 1/4 - shift: the first between the
  // samples i - 1 and i, the second between i and i + 1.
  const std::array<float, 4> even = cubicWeights(0.75 - shift);
  const std::array<float, 4> odd = cubicWeights(0.25 - shift);
  constexpr int kMargin = 2;
  row_.resize(std::max(row_.size(), static_cast<std::size_t>(in.stride + 2 * kMargin)));
  float* middle = row_.data() + kMargin;
  for (int y = 0; y < out.height; ++y) {
    const int first = y / 2 - (y % 2 == 0 ? 2 : 1);
    std::array<const float*, 4> rows{};
    for (int k = 0; k < 4; ++k) {
      rows[static_cast<std::size_t>(k)] = in.row(std::clamp(first + k, 0, in.height - 1));
    }
    mixFourRows(rows, y % 2 == 0 ? even : odd, in.width, middle);
    std::fill_n(middle - kMargin, kMargin, middle[0]);
    std::fill_n(middle + in.width, kMargin, middle[in.width - 1]);
    addEnlargedRow(middle, even, odd, out.width / 2, out.row(y));
    if (out.width % 2 == 1) {
      const float* at = middle + out.width / 2;
      out.row(y)[out.width - 1] += even[0] * at[-2] + even[1] * at[-1] + even[2] * at[0] + even[3] * at[1];
    }
  }
}

void addAbsoluteDifference(const Plane& a, const Plane& b, Plane& sum) {
  addAbsoluteDifferenceRow(a.values.data(), b.values.data(), a.values.size(), sum.values.data());
}

}  // namespace saccade
