#include "saccade/attention/saliency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/hal/hal.hpp>

#include "attention/plane_filters.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kChannels = 3;  // intensity, red/green, blue/yellow

/// Contrast below this is rounding of floats, not the image: a difference of one grey level in one pixel gives more.
constexpr float kLeastContrast = 1e-6F;

/// Opponent colours from sums over `1 / scale / 255` pixels of blue, green and red, relative to those of one pixel.
/// Contrast does not see the reference; with it a uniform image is exactly 0.
SACCADE_MULTIVERSION void opponentRow(const std::uint16_t* blue, const std::uint16_t* green, const std::uint16_t* red,
                                      const std::array<float, 3>& reference, float scale, int columns, float* intensity,
                                      float* red_green, float* blue_yellow) {
  const float blue0 = reference[0], green0 = reference[1], red0 = reference[2];
  for (int x = 0; x < columns; ++x) {
    const float b = static_cast<float>(blue[x]) - blue0;
    const float g = static_cast<float>(green[x]) - green0;
    const float r = static_cast<float>(red[x]) - red0;
    intensity[x] = (b + g + r) * (scale / 3.0F);
    red_green[x] = (r - g) * scale;
    blue_yellow[x] = (b - 0.5F * (g + r)) * scale;
  }
}

/// Sums of 2 x 2 bytes.
SACCADE_MULTIVERSION void sumBlocks(const std::uint8_t* upper, const std::uint8_t* lower, int columns,
                                    std::uint16_t* sums) {
  for (int x = 0; x < columns; ++x) {
    sums[x] = static_cast<std::uint16_t>(upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
  }
}

SACCADE_MULTIVERSION std::pair<float, float> rangeOf(const float* values, int count) {
  float low = values[0], high = values[0];
  for (int i = 0; i < count; ++i) {
    low = values[i] < low ? values[i] : low;
    high = values[i] > high ? values[i] : high;
  }
  return {low, high};
}

SACCADE_MULTIVERSION void stretchRow(const float* in, float low, float scale, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    const float v = (in[x] - low) * scale;
    out[x] = v < 0.0F ? 0.0F : (v > 1.0F ? 1.0F : v);
  }
}

double square(double x) {
  return x * x;
}

}  // namespace

void SaliencyConfig::describe(ConfigVisitor& visitor) {
  visitor.integer("first_layer", first_layer, {0, 8}, "", "finest pyramid layer, 0 = the input's resolution");
  visitor.integer("last_layer", last_layer, {0, 8}, "", "coarsest pyramid layer");
  visitor.integer("scales_per_octave", scales_per_octave, {1, 8}, "", "scales between a layer and the next");
  visitor.number("center_sigma", center_sigma, {0.5, 10.0}, "px", "Gaussian of the centre, first scale of a layer");
  visitor.number("surround_sigma", surround_sigma, {0.6, 30.0}, "px", "Gaussian of the surround, first scale");
}

/// The work of one size of image. All pixels of octave o (the reference's layer first_layer + o) are kept 2^reduction_
/// times coarser than VOCUS2 keeps them, with blurs as many times smaller: the centre's blur leaves nothing that the
/// finer pixels could show.
struct SaliencyModel::Pyramid {
  Pyramid(const SaliencyConfig& config, cv::Size image_size);

  void loadOpponentPlanes(const cv::Mat3b& bgr);
  void addContrast(int channel);
  const Plane& fuse();

  cv::Size size;
  int reduction = 0;  ///< the centre's blur is between 2 and 4 of our pixels, or reduction is 0
  int octaves = 0;
  int first_halvings = 0;           ///< from the input to our first octave
  std::vector<float> first_kernel;  ///< to the centre of the first scale of the first octave
  std::vector<float> next_kernel;   ///< from the last scale to that which, halved, starts the next octave
  std::vector<std::vector<float>> center_kernels;    ///< from scale s - 1 to s
  std::vector<std::vector<float>> surround_kernels;  ///< from centre to surround of scale s
  int skipped_layers = 0;
  PlaneFilter filter;
  std::array<Plane, kChannels> opponent;
  std::vector<Plane> halved;    ///< between the opponent planes and the first octave
  std::vector<Plane> contrast;  ///< sum of |C - S|, per octave
  std::vector<Plane> center, center_next, surround;
  std::vector<Plane> enlarged;  ///< from the first octave up to the input's size
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> sums;
};

SaliencyModel::Pyramid::Pyramid(const SaliencyConfig& config, cv::Size image_size) : size(image_size) {
  reduction = std::max(0, static_cast<int>(std::floor(std::log2(config.center_sigma))) - 1);
  skipped_layers = config.first_layer;
  octaves = config.last_layer - config.first_layer + 1;
  first_halvings = config.first_layer + reduction;

  // Variances in input pixels. Layers skipped at the start are blurred with twice the centre's sigma and halved
  // by dropping pixels; a mean over blocks of n x n pixels has a variance of (n^2 - 1) / 12.
  double variance = square(config.center_sigma * std::exp2(config.first_layer));
  for (int layer = 0; layer < config.first_layer; ++layer) {
    variance += square(2.0 * config.center_sigma * std::exp2(layer));
  }
  const double pixel = std::exp2(first_halvings);
  first_kernel = gaussianHalfKernel(std::sqrt(std::max(0.0, variance - (square(pixel) - 1.0) / 12.0)) / pixel);
  const int scales = config.scales_per_octave;
  const double center_px = config.center_sigma / std::exp2(reduction);
  const double widening = std::sqrt(square(config.surround_sigma) - square(config.center_sigma)) / std::exp2(reduction);
  for (int s = 0; s < scales; ++s) {
    const double sigma = center_px * std::exp2(static_cast<double>(s) / scales);
    const double before = center_px * std::exp2(static_cast<double>(s - 1) / scales);
    center_kernels.push_back(s == 0 ? std::vector<float>{1.0F}
                                    : gaussianHalfKernel(std::sqrt(square(sigma) - square(before))));
    surround_kernels.push_back(gaussianHalfKernel(widening * std::exp2(static_cast<double>(s) / scales)));
  }
  const double last = center_px * std::exp2(static_cast<double>(scales - 1) / scales);
  next_kernel = gaussianHalfKernel(std::sqrt(std::max(0.0, square(2.0 * center_px) - square(last) - 0.25)));

  const bool halve_bytes = first_halvings > 0;
  const auto half = [](cv::Size s) { return cv::Size((s.width + 1) / 2, (s.height + 1) / 2); };
  cv::Size level = halve_bytes ? half(size) : size;
  for (Plane& plane : opponent) {
    plane.resize(level.width, level.height);
  }
  enlarged.resize(static_cast<std::size_t>(first_halvings));
  cv::Size fine = size;
  for (int i = 0; i < first_halvings; ++i) {
    enlarged[static_cast<std::size_t>(i)].resize(fine.width, fine.height);
    fine = half(fine);
  }
  for (int i = 1; i < first_halvings; ++i) {
    level = half(level);
    halved.emplace_back().resize(level.width, level.height);
  }
  for (int o = 0; o < octaves; ++o) {
    for (std::vector<Plane>* planes : {&contrast, &center, &center_next, &surround}) {
      planes->emplace_back().resize(level.width, level.height);
    }
    level = half(level);
  }
  bytes.resize(static_cast<std::size_t>(size.width) * kChannels * 2 + 2 * kBlock);
  sums.resize(static_cast<std::size_t>(size.width) * kChannels + kBlock);
}

void SaliencyModel::Pyramid::loadOpponentPlanes(const cv::Mat3b& bgr) {
  const std::size_t width = static_cast<std::size_t>(size.width);
  const bool halves = first_halvings > 0;
  const int columns = opponent[0].width;
  const float scale = 1.0F / (halves ? 4.0F * 255.0F : 255.0F);
  const cv::Vec3b corner = bgr(0, 0);
  const float pixels = halves ? 4.0F : 1.0F;
  const std::array<float, 3> reference{pixels * corner[0], pixels * corner[1], pixels * corner[2]};
  for (int y = 0; y < opponent[0].height; ++y) {
    std::array<std::uint8_t*, kChannels> upper{}, lower{};
    std::array<std::uint16_t*, kChannels> sum{};
    for (std::size_t c = 0; c < kChannels; ++c) {
      upper[c] = bytes.data() + 2 * c * width;
      lower[c] = upper[c] + width;
      sum[c] = sums.data() + c * width;
    }
    if (halves) {
      cv::hal::split8u(bgr.ptr(2 * y), upper.data(), size.width, kChannels);
      cv::hal::split8u(bgr.ptr(std::min(2 * y + 1, size.height - 1)), lower.data(), size.width, kChannels);
    } else {
      cv::hal::split8u(bgr.ptr(y), upper.data(), size.width, kChannels);
    }
    for (std::size_t c = 0; c < kChannels; ++c) {
      if (!halves) {
        std::copy_n(upper[c], width, sum[c]);
        continue;
      }
      sumBlocks(upper[c], lower[c], size.width / 2, sum[c]);
      if (width % 2 == 1) {
        sum[c][columns - 1] = static_cast<std::uint16_t>(2 * (upper[c][width - 1] + lower[c][width - 1]));
      }
    }
    opponentRow(sum[0], sum[1], sum[2], reference, scale, columns, opponent[0].row(y), opponent[1].row(y),
                opponent[2].row(y));
  }
}

void SaliencyModel::Pyramid::addContrast(int channel) {
  const Plane* plane = &opponent[static_cast<std::size_t>(channel)];
  for (Plane& next : halved) {
    filter.halve(*plane, next);
    plane = &next;
  }
  filter.blur(*plane, first_kernel, center[0]);
  for (std::size_t o = 0; o < contrast.size(); ++o) {
    for (std::size_t s = 0; s < surround_kernels.size(); ++s) {
      if (s > 0) {
        filter.blur(center[o], center_kernels[s], center_next[o]);
        std::swap(center[o].values, center_next[o].values);
      }
      filter.blur(center[o], surround_kernels[s], surround[o]);
      addAbsoluteDifference(center[o], surround[o], contrast[o]);
    }
    if (o + 1 < contrast.size()) {
      filter.blur(center[o], next_kernel, center_next[o]);
      filter.halve(center_next[o], center[o + 1]);
    }
  }
}

/// Sums the octaves from coarse to fine, and enlarges the sum to the input's size.
///
/// VOCUS2 halves by keeping every other pixel and enlarges with centres aligned, which moves the content of layer l by
/// (2^l - 1) / 2 input pixels. We halve by means of blocks, which moves nothing, and shift when enlarging by a layer.
const Plane& SaliencyModel::Pyramid::fuse() {
  const double layer_shift = 0.25 / std::exp2(reduction);
  for (std::size_t o = contrast.size() - 1; o > 0; --o) {
    filter.addEnlarged(contrast[o], layer_shift, contrast[o - 1]);
  }
  const Plane* sum = &contrast[0];
  for (std::size_t i = enlarged.size(); i > 0; --i) {
    Plane& finer = enlarged[i - 1];
    std::fill(finer.values.begin(), finer.values.end(), 0.0F);
    filter.addEnlarged(*sum, static_cast<int>(enlarged.size() - i) < skipped_layers ? layer_shift : 0.0, finer);
    sum = &finer;
  }
  return *sum;
}

SaliencyModel::SaliencyModel(SaliencyConfig config) : config_(config) {
  requireValid(config_);
  if (config_.last_layer < config_.first_layer) {
    throw std::invalid_argument("saliency: expected last_layer >= first_layer, found " +
                                std::to_string(config_.last_layer) + " < " + std::to_string(config_.first_layer));
  }
  if (!(config_.surround_sigma > config_.center_sigma)) {
    throw std::invalid_argument("saliency: expected surround_sigma > center_sigma, found " +
                                std::to_string(config_.surround_sigma) + " <= " + std::to_string(config_.center_sigma));
  }
}

SaliencyModel::~SaliencyModel() = default;
SaliencyModel::SaliencyModel(SaliencyModel&&) noexcept = default;
SaliencyModel& SaliencyModel::operator=(SaliencyModel&&) noexcept = default;

const cv::Mat1f& SaliencyModel::compute(const cv::Mat3b& bgr) {
  if (bgr.empty()) {
    throw std::invalid_argument("saliency: expected an image, found an empty one");
  }
  if (!pyramid_ || pyramid_->size != bgr.size()) {
    pyramid_ = std::make_unique<Pyramid>(config_, bgr.size());
    map_.create(bgr.size());
  }
  for (Plane& contrast : pyramid_->contrast) {
    std::fill(contrast.values.begin(), contrast.values.end(), 0.0F);
  }
  pyramid_->loadOpponentPlanes(bgr);
  for (int channel = 0; channel < kChannels; ++channel) {
    pyramid_->addContrast(channel);
  }
  const Plane& sum = pyramid_->fuse();

  float low = sum.row(0)[0], high = low;
  for (int y = 0; y < sum.height; ++y) {
    const auto [row_low, row_high] = rangeOf(sum.row(y), sum.width);
    low = std::min(low, row_low);
    high = std::max(high, row_high);
  }
  const float scale = high - low < kLeastContrast ? 0.0F : 1.0F / (high - low);
  for (int y = 0; y < sum.height; ++y) {
    stretchRow(sum.row(y), low, scale, sum.width, map_.ptr<float>(y));
  }
  return map_;
}

}  // namespace saccade
