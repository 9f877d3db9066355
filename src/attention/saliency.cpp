#include "saccade/attention/saliency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
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
  for (int x = 0; x < columns; ++x) {  // two bytes as one word: the loop loads and adds whole vectors of words
    std::uint16_t above, below;
    std::memcpy(&above, upper + 2 * x, sizeof above);
    std::memcpy(&below, lower + 2 * x, sizeof below);
    sums[x] = static_cast<std::uint16_t>((above & 0xFF) + (above >> 8) + (below & 0xFF) + (below >> 8));
  }
}

/// Widens the ranges low[i] ... high[i], one for each column of a block, by the values of a row of whole blocks.
SACCADE_MULTIVERSION void widenRanges(const float* values, int blocks, float* low, float* high) {
  for (int b = 0; b < blocks; ++b) {
    for (int i = 0; i < kBlock; ++i) {
      const float v = values[b * kBlock + i];
      low[i] = v < low[i] ? v : low[i];
      high[i] = v > high[i] ? v : high[i];
    }
  }
}

SACCADE_MULTIVERSION void stretchRow(float low, float scale, int columns, float* values) {
  for (int x = 0; x < columns; ++x) {
    const float v = (values[x] - low) * scale;
    values[x] = v < 0.0F ? 0.0F : (v > 1.0F ? 1.0F : v);
  }
}

double square(double x) {
  return x * x;
}

/// Bytes from one channel of a split row to the next: OpenCV writes channels that begin at equal remainders of a vector
/// past the cache, and to read them back from memory would take as long as all the rest of their work.
std::size_t splitStride(int width) {
  return static_cast<std::size_t>((width + kBlock - 1) / kBlock * kBlock + 1);
}

std::vector<float> kernelOfVariance(double variance) {
  return gaussianHalfKernel(std::sqrt(std::max(0.0, variance)));
}

/// One layer of the twin pyramids, of one channel at a time; kernels are in pixels of the octave or of its half.
struct Octave {
  int pixel_log2 = 0;               ///< its pixels are 2^pixel_log2 of the input's wide
  double shift = 0.0;               ///< px, by which its content is moved when added to the octave before
  bool surround_is_halved = false;  ///< the surround is kept at half the octave's size
  bool next_is_halved = false;      ///< the next octave is of half its size, else of the same
  std::vector<std::vector<float>> center_kernels;    ///< from the centre of scale s - 1 to that of scale s
  std::vector<std::vector<float>> surround_kernels;  ///< from the (halved) centre to the surround of scale s
  std::vector<float> next_kernel;                    ///< from the (halved) last centre to that of the next octave
  Plane center, next_center, half_center, surround;
  Plane contrast;  ///< sum of |C - S|
};

/// Of the filter of PlaneFilter::halve, in pixels of the result.
constexpr double kHalvingVariance = 1.0 / 8.0;

}  // namespace

void SaliencyConfig::describe(ConfigVisitor& visitor) {
  visitor.integer("first_layer", first_layer, {0, 8}, "", "finest pyramid layer, 0 = the input's resolution");
  visitor.integer("last_layer", last_layer, {0, 8}, "", "coarsest pyramid layer");
  visitor.integer("scales_per_octave", scales_per_octave, {1, 8}, "", "scales between a layer and the next");
  visitor.number("center_sigma", center_sigma, {0.5, 10.0}, "px", "Gaussian of the centre, first scale of a layer");
  visitor.number("surround_sigma", surround_sigma, {0.6, 30.0}, "px", "Gaussian of the surround, first scale");
}

/// The work of one size of image.
///
/// An image blurred with a Gaussian of one pixel or more can be kept at that pixel size and blurred on there. So the
/// fine layers are kept coarser than VOCUS2 keeps them, where the centre's blur is one to two pixels, and surrounds
/// twice as coarse again where they are wide enough. The coarse layers cost little and stay as VOCUS2 has them: there
/// the image's border, where its last pixels are replicated, is wide.
struct SaliencyModel::Pyramid {
  Pyramid(const SaliencyConfig& config, cv::Size image_size);

  void makeOctave(const SaliencyConfig& config, int layer);
  void makePlanes();
  void loadOpponentPlanes(const cv::Mat3b& bgr);
  void addContrast(int channel);
  const Plane& fuse();
  void stretch(const Plane& sum, cv::Mat1f& map);

  cv::Size size;
  int first_halvings = 0;           ///< from the input to the first octave
  int skipped_layers = 0;           ///< of the halvings, those that VOCUS2 makes too
  std::vector<float> first_kernel;  ///< to the centre of the first scale of the first octave
  PlaneFilter filter;
  std::array<Plane, kChannels> opponent;
  std::vector<Plane> reduced;  ///< between the opponent planes and the first octave
  std::vector<Octave> octaves;
  std::vector<Plane> enlarged;  ///< between the first octave and the input's size
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> sums;
};

SaliencyModel::Pyramid::Pyramid(const SaliencyConfig& config, cv::Size image_size) : size(image_size) {
  const int reduction = std::max(0, static_cast<int>(std::floor(std::log2(config.center_sigma))));
  skipped_layers = config.first_layer;
  first_halvings = config.first_layer + reduction;

  // Variances in input pixels. Layers skipped at the start are blurred with twice the centre's sigma and halved by
  // dropping pixels. Our first halving is the mean of blocks of 2 x 2 pixels, the others blur a little, too.
  double variance = square(config.center_sigma * std::exp2(config.first_layer));
  for (int layer = 0; layer < config.first_layer; ++layer) {
    variance += square(2.0 * config.center_sigma * std::exp2(layer));
  }
  for (int halving = 1; halving <= first_halvings; ++halving) {
    variance -= halving == 1 ? 0.25 : kHalvingVariance * square(std::exp2(halving));
  }
  first_kernel = kernelOfVariance(variance / square(std::exp2(first_halvings)));

  for (int layer = config.first_layer; layer <= config.last_layer; ++layer) {
    makeOctave(config, layer);
  }
  makePlanes();
}

void SaliencyModel::Pyramid::makeOctave(const SaliencyConfig& config, int layer) {
  const auto pixelLog2 = [&](int l) {
    return std::max(l, std::min(l - config.first_layer + first_halvings, first_halvings + 1));
  };
  Octave& octave = octaves.emplace_back();
  octave.pixel_log2 = pixelLog2(layer);
  octave.next_is_halved = pixelLog2(layer + 1) > octave.pixel_log2;
  octave.shift = std::exp2(layer - 2 - octave.pixel_log2);

  const double layer_pixel = std::exp2(layer - octave.pixel_log2);
  const double center = square(config.center_sigma * layer_pixel);
  const double widening = square(config.surround_sigma * layer_pixel) - center;
  octave.surround_is_halved = octave.pixel_log2 <= first_halvings + 1 && widening / 4.0 > 4.0 * kHalvingVariance;
  const int scales = config.scales_per_octave;
  for (int s = 0; s < scales; ++s) {
    const double growth = std::exp2(2.0 * s / scales), growth_before = std::exp2(2.0 * (s - 1) / scales);
    octave.center_kernels.push_back(kernelOfVariance(s > 0 ? center * (growth - growth_before) : 0.0));
    octave.surround_kernels.push_back(
        kernelOfVariance(octave.surround_is_halved ? widening * growth / 4.0 - kHalvingVariance : widening * growth));
  }
  const double missing = center * (4.0 - std::exp2(2.0 * (scales - 1) / scales));
  octave.next_kernel = kernelOfVariance(octave.next_is_halved ? missing / 4.0 - kHalvingVariance : missing);
}

void SaliencyModel::Pyramid::makePlanes() {
  const auto half = [](cv::Size s) { return cv::Size((s.width + 1) / 2, (s.height + 1) / 2); };
  const auto resize = [](Plane& plane, cv::Size s) { plane.resize(s.width, s.height); };
  cv::Size level = first_halvings > 0 ? half(size) : size;
  for (Plane& plane : opponent) {
    resize(plane, level);
  }
  for (int i = 1; i < first_halvings; ++i) {
    resize(enlarged.emplace_back(), level);
    level = half(level);
    resize(reduced.emplace_back(), level);
  }
  for (Octave& octave : octaves) {
    resize(octave.contrast, level);
    resize(octave.center, level);
    resize(octave.next_center, level);
    resize(octave.half_center, half(level));
    resize(octave.surround, octave.surround_is_halved ? half(level) : level);
    level = octave.next_is_halved ? half(level) : level;
  }
  bytes.resize(splitStride(size.width) * kChannels * 2);
  sums.resize(static_cast<std::size_t>(size.width) * kChannels + kBlock);
}

void SaliencyModel::Pyramid::loadOpponentPlanes(const cv::Mat3b& bgr) {
  const std::size_t width = static_cast<std::size_t>(size.width), stride = splitStride(size.width);
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
      upper[c] = bytes.data() + c * stride;
      lower[c] = upper[c] + kChannels * stride;
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
  for (Plane& next : reduced) {
    filter.halve(*plane, next);
    plane = &next;
  }
  filter.blur(*plane, first_kernel, octaves[0].center);
  for (std::size_t o = 0; o < octaves.size(); ++o) {
    Octave& octave = octaves[o];
    for (std::size_t s = 0; s < octave.surround_kernels.size(); ++s) {
      if (s > 0) {
        filter.blur(octave.center, octave.center_kernels[s], octave.next_center);
        std::swap(octave.center, octave.next_center);
      }
      if (octave.surround_is_halved || (octave.next_is_halved && s + 1 == octave.surround_kernels.size())) {
        filter.halve(octave.center, octave.half_center);
      }
      filter.blur(octave.surround_is_halved ? octave.half_center : octave.center, octave.surround_kernels[s],
                  octave.surround);
      filter.addContrast(octave.center, octave.surround, octave.contrast);
    }
    if (o + 1 < octaves.size()) {
      filter.blur(octave.next_is_halved ? octave.half_center : octave.center, octave.next_kernel,
                  octaves[o + 1].center);
    }
  }
}

/// Sums the octaves from coarse to fine.
///
/// VOCUS2 halves by keeping every other pixel, as we do, but enlarges with the images' centres aligned, which moves the
/// content of layer l by (2^l - 1) / 2 input pixels: by a quarter of a pixel of the layer from each layer to the one
/// before.
const Plane& SaliencyModel::Pyramid::fuse() {
  for (std::size_t o = octaves.size() - 1; o > 0; --o) {
    filter.addResampled(octaves[o].contrast, octaves[o].shift, octaves[o - 1].contrast);
  }
  return octaves[0].contrast;
}

/// Enlarges the sum to the input's size and stretches its values to [0, 1].
void SaliencyModel::Pyramid::stretch(const Plane& fused, cv::Mat1f& map) {
  const Plane* sum = &fused;
  // The content of skipped layers is moved, too; pixels of the first halving lie between those of the input.
  const double layer_shift = octaves[0].shift;
  const auto shiftAfter = [&](int halvings) {
    return (first_halvings - halvings < skipped_layers ? layer_shift : 0.0) + (halvings == 1 ? 0.25 : 0.0);
  };
  int halvings = first_halvings;
  for (; halvings > 1; --halvings) {
    Plane& finer = enlarged[static_cast<std::size_t>(halvings - 2)];
    for (int y = 0; y < finer.height; ++y) {
      filter.enlargeOneRow(*sum, shiftAfter(halvings), y, finer.width, finer.row(y));
    }
    sum = &finer;
  }
  std::array<float, kBlock> lowest, highest;
  lowest.fill(std::numeric_limits<float>::max());
  highest.fill(std::numeric_limits<float>::lowest());
  for (int y = 0; y < size.height; ++y) {
    float* row = map[y];
    if (halvings == 1) {
      filter.enlargeOneRow(*sum, shiftAfter(halvings), y, size.width, row);
    } else {
      std::copy_n(sum->row(y), size.width, row);
    }
    widenRanges(row, size.width / kBlock, lowest.data(), highest.data());
    for (int x = size.width / kBlock * kBlock; x < size.width; ++x) {
      lowest[0] = std::min(lowest[0], row[x]);
      highest[0] = std::max(highest[0], row[x]);
    }
  }
  const float low = *std::min_element(lowest.begin(), lowest.end());
  const float high = *std::max_element(highest.begin(), highest.end());
  const float scale = high - low < kLeastContrast ? 0.0F : 1.0F / (high - low);
  for (int y = 0; y < size.height; ++y) {
    stretchRow(low, scale, size.width, map[y]);
  }
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
  compute(bgr, map_);
  return map_;
}

void SaliencyModel::compute(const cv::Mat3b& bgr, cv::Mat1f& map) {
  if (bgr.empty()) {
    throw std::invalid_argument("saliency: expected an image, found an empty one");
  }
  if (!pyramid_ || pyramid_->size != bgr.size()) {
    pyramid_ = std::make_unique<Pyramid>(config_, bgr.size());
  }
  for (Octave& octave : pyramid_->octaves) {
    std::fill(octave.contrast.values.begin(), octave.contrast.values.end(), 0.0F);
  }
  pyramid_->loadOpponentPlanes(bgr);
  for (int channel = 0; channel < kChannels; ++channel) {
    pyramid_->addContrast(channel);
  }
  map.create(bgr.size());
  pyramid_->stretch(pyramid_->fuse(), map);
}

}  // namespace saccade
