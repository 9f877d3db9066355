#include "saccade/segmentation/color_segments.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include <opencv2/core/hal/hal.hpp>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kChannels = 3;
constexpr int kDirections = 4;
constexpr std::uint16_t kNoEdge = 0xFFFF;

// Weights are kept as steps: the highest bits of the squared distance as a float, which rise with the distance by 0.1 %
// each. Where components are large, k / |C| is a hundredth of a grey level: equal steps of that size would be too many.
constexpr int kStepShift = 23 - 9;
constexpr int kStepOfLeast = (127 - 10) << 9;  // a squared distance of 2^-10, all below are step 0
constexpr int kSteps = 28 << 9;                // 3 * 255^2 < 2^18

/// The distance, in grey levels, of the middle of a step.
float distanceOfStep(std::uint32_t step) {
  return step == 0 ? 0.0F
                   : std::sqrt(std::bit_cast<float>((step + static_cast<std::uint32_t>(kStepOfLeast)) << kStepShift |
                                                    1U << (kStepShift - 1)));
}

constexpr int kMargin = 32;  // floats around a row, so that neighbours can be read beyond its ends

std::size_t rowLength(int width) {
  return static_cast<std::size_t>(width) + 2 * kMargin;
}

SACCADE_MULTIVERSION void blurRow(const float* in, const float* weights, int radius, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] = weights[0] * in[x];
  }
  for (int k = 1; k <= radius; ++k) {
    const float w = weights[k];
    for (int x = 0; x < columns; ++x) {
      out[x] += w * (in[x - k] + in[x + k]);
    }
  }
}

SACCADE_MULTIVERSION void toFloats(const std::uint8_t* in, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] = static_cast<float>(in[x]);
  }
}

SACCADE_MULTIVERSION void scaleRow(const float* in, float weight, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] = weight * in[x];
  }
}

SACCADE_MULTIVERSION void addRows(const float* above, const float* below, float weight, int columns, float* out) {
  for (int x = 0; x < columns; ++x) {
    out[x] += weight * (above[x] + below[x]);
  }
}

/// Weights of the edges from each pixel of the row `here` to the one at `offset` in the row `there`, in steps.
SACCADE_MULTIVERSION void weighRow(const float* here, const float* there, std::size_t length, int offset, int columns,
                                   std::uint16_t* weights) {
  const float *b0 = here, *g0 = here + length, *r0 = here + 2 * length;
  const float *b1 = there + offset, *g1 = b1 + length, *r1 = g1 + length;
  for (int x = 0; x < columns; ++x) {
    const float b = b0[x] - b1[x], g = g0[x] - g1[x], r = r0[x] - r1[x];
    const int step = (std::bit_cast<int>(b * b + g * g + r * r) >> kStepShift) - kStepOfLeast;
    weights[x] = static_cast<std::uint16_t>(step < 0 ? 0 : step);
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

void ColorSegmentsConfig::describe(ConfigVisitor& visitor) {
  visitor.number("k", k, {0.0, 1e6}, "", "scale of observation, larger gives larger segments");
  visitor.number("sigma", sigma, {0.0, 5.0}, "px", "Gaussian smoothing before segmentation");
  visitor.integer("min_size", min_size, {1, 1e9}, "px", "smaller segments join their most similar neighbour");
}

ColorSegmenter::ColorSegmenter(ColorSegmentsConfig config) : config_(config) {
  requireValid(config_);
  half_kernel_ = gaussianHalfKernel(config_.sigma);
}

const Segmentation& ColorSegmenter::segment(const cv::Mat3b& bgr) {
  if (bgr.empty()) {
    throw std::invalid_argument("colour segments: expected an image, found an empty one");
  }
  resize(bgr.size());
  weighEdges(bgr);
  std::iota(parent_.begin(), parent_.end(), 0);
  std::fill(roots_.begin(), roots_.end(), Root{static_cast<float>(config_.k), 1});
  rejected_.clear();

  // Three batches by rising weight. By the time of the second most edges lie inside a component; they are dropped in
  // row order, which costs far less than to sort them and look their ends up in the order of weights.
  const std::uint32_t light = stepAtShare(0.35), middle = std::max(light, stepAtShare(0.7));
  gatherLightEdges(light);
  sortBatch();
  mergeBatch();
  flattenComponents();
  gatherHeavyEdges(light);
  takePendingEdges(middle);
  sortBatch();
  mergeBatch();
  takePendingEdges(kSteps);
  sortBatch();
  mergeBatch();

  absorbSmallSegments();
  labelSegments();
  return segmentation_;
}

void ColorSegmenter::resize(cv::Size size) {
  if (size == size_) {
    return;
  }
  size_ = size;
  const std::size_t pixels = static_cast<std::size_t>(size.area());
  const std::size_t length = rowLength(size.width);
  split_.assign(kChannels * static_cast<std::size_t>(size.width), 0);
  raw_row_.assign(length, 0.0F);
  row_blurs_.assign((2 * half_kernel_.size() - 1) * kChannels * length, 0.0F);
  smooth_.assign(2 * kChannels * length, 0.0F);
  weights_.assign(kDirections * pixels, kNoEdge);
  batch_.resize(kDirections * pixels);
  pending_.resize(kDirections * pixels);
  sorted_.resize(kDirections * pixels);
  rejected_.reserve(kDirections * pixels);
  step_positions_.resize(kSteps + 1);
  parent_.resize(pixels);
  roots_.resize(pixels);
  segmentation_.labels.create(size);
}

/// Smooths the image row by row and weighs the edges between a row and the next as soon as both are there.
void ColorSegmenter::weighEdges(const cv::Mat3b& bgr) {
  const std::size_t length = rowLength(size_.width), width = static_cast<std::size_t>(size_.width);
  const int radius = static_cast<int>(half_kernel_.size()) - 1;
  for (int y = 0; y < std::min(radius, size_.height); ++y) {
    blurAlongRow(bgr, y);
  }
  const auto smoothRow = [&](int y) {
    return smooth_.data() + static_cast<std::size_t>(y % 2) * kChannels * length + kMargin;
  };
  for (int y = 0; y < size_.height; ++y) {
    if (y + radius < size_.height) {
      blurAlongRow(bgr, y + radius);
    }
    blurAcrossRows(y);
    std::uint16_t* weights = weights_.data() + static_cast<std::size_t>(y) * kDirections * width;
    weighRow(smoothRow(y), smoothRow(y), length, 1, size_.width - 1, weights);
    if (y > 0) {
      std::uint16_t* above = weights - kDirections * width;
      weighRow(smoothRow(y - 1), smoothRow(y), length, 0, size_.width, above + width);
      weighRow(smoothRow(y - 1), smoothRow(y), length, 1, size_.width - 1, above + 2 * width);
      weighRow(smoothRow(y - 1) + 1, smoothRow(y) + 1, length, -1, size_.width - 1, above + 3 * width + 1);
    }
  }
}

void ColorSegmenter::blurAlongRow(const cv::Mat3b& bgr, int row) {
  const std::size_t length = rowLength(size_.width), width = static_cast<std::size_t>(size_.width);
  const int radius = static_cast<int>(half_kernel_.size()) - 1;
  std::array<std::uint8_t*, kChannels> split{split_.data(), split_.data() + width, split_.data() + 2 * width};
  cv::hal::split8u(bgr.ptr(row), split.data(), size_.width, kChannels);
  float* out = row_blurs_.data() + static_cast<std::size_t>(row % (2 * radius + 1)) * kChannels * length + kMargin;
  float* raw = raw_row_.data() + kMargin;
  for (std::size_t c = 0; c < kChannels; ++c) {
    toFloats(split[c], size_.width, raw);
    std::fill_n(raw - radius, radius, raw[0]);
    std::fill_n(raw + width, radius, raw[width - 1]);
    blurRow(raw, half_kernel_.data(), radius, size_.width, out + c * length);
  }
}

void ColorSegmenter::blurAcrossRows(int row) {
  const std::size_t length = rowLength(size_.width);
  const int radius = static_cast<int>(half_kernel_.size()) - 1;
  const auto blurred = [&](int y) {
    const int inside = std::clamp(y, 0, size_.height - 1);
    return row_blurs_.data() + static_cast<std::size_t>(inside % (2 * radius + 1)) * kChannels * length;
  };
  // All three channels and their margins are one run of floats.
  const int columns = static_cast<int>(kChannels * length);
  float* out = smooth_.data() + static_cast<std::size_t>(row % 2) * kChannels * length;
  scaleRow(blurred(row), half_kernel_[0], columns, out);
  for (int k = 1; k <= radius; ++k) {
    addRows(blurred(row - k), blurred(row + k), half_kernel_[static_cast<std::size_t>(k)], columns, out);
  }
}

/// The step below which about `share` of all edges lie, estimated on every 8th row.
std::uint32_t ColorSegmenter::stepAtShare(double share) const {
  std::vector<std::uint32_t> counts(kSteps, 0);
  const std::size_t row_weights = kDirections * static_cast<std::size_t>(size_.width);
  std::size_t total = 0;
  for (std::size_t y = 0; y < static_cast<std::size_t>(size_.height); y += 8) {
    for (std::size_t i = 0; i < row_weights; ++i) {
      const std::uint16_t step = weights_[y * row_weights + i];
      if (step != kNoEdge) {
        ++counts[step];
        ++total;
      }
    }
  }
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(total));
  std::size_t sum = 0;
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    sum += counts[step];
    if (sum >= wanted) {
      return step + 1;
    }
  }
  return kSteps;
}

/// Fills the batch with all edges of less than `end_step`.
void ColorSegmenter::gatherLightEdges(std::uint32_t end_step) {
  const std::size_t width = static_cast<std::size_t>(size_.width), rows = static_cast<std::size_t>(size_.height);
  WeightedEdge* out = batch_.data();
  const std::uint16_t* weights = weights_.data();
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t d = 0; d < kDirections; ++d, weights += width) {
      const Edge first = static_cast<Edge>(y * width * kDirections + d);
      for (std::size_t x = 0; x < width; ++x) {
        *out = {first + static_cast<Edge>(x * kDirections), weights[x]};
        out += weights[x] < end_step ? 1 : 0;
      }
    }
  }
  batch_size_ = static_cast<std::size_t>(out - batch_.data());
}

/// Fills `pending_` with the edges of at least `first_step` between different components, which must be flat.
void ColorSegmenter::gatherHeavyEdges(std::uint32_t first_step) {
  const std::size_t width = static_cast<std::size_t>(size_.width), rows = static_cast<std::size_t>(size_.height);
  const std::array<std::size_t, kDirections> offsets{1, width, width + 1, width - 1};
  WeightedEdge* out = pending_.data();
  const std::uint16_t* weights = weights_.data();
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t d = 0; d < kDirections; ++d, weights += width) {
      if (y + 1 == rows && d > 0) {
        continue;
      }
      const Edge first = static_cast<Edge>(y * width * kDirections + d);
      const int* here = parent_.data() + y * width;
      const int* there = here + offsets[d];
      const std::size_t end = y + 1 == rows || (y + 2 == rows && d == 2) ? width - 1 : width;
      for (std::size_t x = 0; x < end; ++x) {
        *out = {first + static_cast<Edge>(x * kDirections), weights[x]};
        out += (weights[x] >= first_step) & (weights[x] != kNoEdge) & (here[x] != there[x]) ? 1 : 0;
      }
    }
  }
  pending_size_ = static_cast<std::size_t>(out - pending_.data());
}

/// Moves the pending edges of less than `end_step` between different components to the batch.
void ColorSegmenter::takePendingEdges(std::uint32_t end_step) {
  WeightedEdge* taken = batch_.data();
  WeightedEdge* kept = pending_.data();
  for (std::size_t i = 0; i < pending_size_; ++i) {
    const WeightedEdge edge = pending_[i];
    *taken = edge;
    *kept = edge;
    const bool take = edge.step < end_step;
    taken += take ? 1 : 0;
    kept += take ? 0 : 1;
  }
  batch_size_ = static_cast<std::size_t>(taken - batch_.data());
  pending_size_ = static_cast<std::size_t>(kept - pending_.data());
}

/// Counting sort by weight; equal weights stay in row order.
void ColorSegmenter::sortBatch() {
  std::fill(step_positions_.begin(), step_positions_.end(), 0U);
  for (std::size_t i = 0; i < batch_size_; ++i) {
    ++step_positions_[batch_[i].step];
  }
  std::exclusive_scan(step_positions_.begin(), step_positions_.end(), step_positions_.begin(), 0U);
  for (std::size_t i = 0; i < batch_size_; ++i) {
    sorted_[step_positions_[batch_[i].step]++] = batch_[i];
  }
}

void ColorSegmenter::mergeBatch() {
  const std::array<int, kDirections> offsets{1, size_.width, size_.width + 1, size_.width - 1};
  const float k = static_cast<float>(config_.k);
  for (std::size_t i = 0; i < batch_size_; ++i) {
    const auto [edge, step] = sorted_[i];
    const int pixel = static_cast<int>(edge / kDirections);
    const int a = find(pixel);
    const int b = find(pixel + offsets[edge % kDirections]);
    if (a == b) {
      continue;
    }
    const float weight = distanceOfStep(step);
    if (weight <= roots_[static_cast<std::size_t>(a)].threshold &&
        weight <= roots_[static_cast<std::size_t>(b)].threshold) {
      Root& root = roots_[static_cast<std::size_t>(unite(a, b))];
      root.threshold = weight + k / static_cast<float>(root.area);
    } else {
      rejected_.push_back(edge);
    }
  }
}

void ColorSegmenter::flattenComponents() {
  for (int i = 0; i < static_cast<int>(parent_.size()); ++i) {
    parent_[static_cast<std::size_t>(i)] = find(i);
  }
}

/// Joins segments under the smallest size to the neighbour across their lightest edge.
void ColorSegmenter::absorbSmallSegments() {
  const std::array<int, kDirections> offsets{1, size_.width, size_.width + 1, size_.width - 1};
  for (const Edge edge : rejected_) {
    const int pixel = static_cast<int>(edge / kDirections);
    const int a = find(pixel);
    const int b = find(pixel + offsets[edge % kDirections]);
    if (a != b && std::min(roots_[static_cast<std::size_t>(a)].area, roots_[static_cast<std::size_t>(b)].area) <
                      config_.min_size) {
      unite(a, b);
    }
  }
}

void ColorSegmenter::labelSegments() {
  constexpr int kUnlabelled = -1;
  for (Root& root : roots_) {
    root.area = kUnlabelled;  // areas are not needed any more; the field takes the label
  }
  int* labels = segmentation_.labels.ptr<int>();
  segmentation_.count = 0;
  for (int i = 0; i < static_cast<int>(parent_.size()); ++i) {
    int& label = roots_[static_cast<std::size_t>(find(i))].area;
    if (label == kUnlabelled) {
      label = segmentation_.count++;
    }
    labels[i] = label;
  }
}

int ColorSegmenter::find(int pixel) {
  int* parent = parent_.data();
  while (parent[pixel] != pixel) {
    parent[pixel] = parent[parent[pixel]];
    pixel = parent[pixel];
  }
  return pixel;
}

/// Joins two components; the root of the larger one stays.
int ColorSegmenter::unite(int root, int other_root) {
  if (roots_[static_cast<std::size_t>(root)].area < roots_[static_cast<std::size_t>(other_root)].area) {
    std::swap(root, other_root);
  }
  parent_[static_cast<std::size_t>(other_root)] = root;
  roots_[static_cast<std::size_t>(root)].area += roots_[static_cast<std::size_t>(other_root)].area;
  return root;
}

}  // namespace saccade
