#include "segmentation/label_upsampling.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include <opencv2/core/hal/hal.hpp>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kBlock = 32;  // columns of one block of the inner loops; rows are padded to it

std::size_t padded(int width) {
  const int blocks = (width + kBlock - 1) / kBlock;
  return static_cast<std::size_t>(blocks) * kBlock;
}

/// The rounded means of blocks of 2 x 2 pixels, beginning at the first of `columns` even columns.
SACCADE_MULTIVERSION void meanOfRows(const std::uint8_t* above, const std::uint8_t* below, int columns,
                                     std::uint8_t* mean) {
  for (int x = 0; x < columns; ++x) {
    for (int c = 0; c < 3; ++c) {
      const int left = 6 * x + c, right = left + 3;
      mean[3 * x + c] = static_cast<std::uint8_t>((above[left] + above[right] + below[left] + below[right] + 2) / 4);
    }
  }
}

/// Three channels of a row.
struct Colors {
  const std::uint8_t *b, *g, *r;
};

/// One row of labels and the pixels they belong to.
struct Labelled {
  Colors color;
  const std::int32_t* label;
};

/// Gives each pixel the label of the most alike of four; of equals the first. Whole blocks.
SACCADE_MULTIVERSION void chooseLabels(const Colors& pixels, const std::array<Labelled, 4>& choice, int columns,
                                       std::int32_t* out) {
  const std::int32_t *label_0 = choice[0].label, *label_1 = choice[1].label, *label_2 = choice[2].label,
                     *label_3 = choice[3].label;
  for (int x = 0; x < columns; x += kBlock) {
    std::int32_t differ = 0;
    for (int i = x; i < x + kBlock; ++i) {
      out[i] = label_0[i];
      differ |= (label_0[i] ^ label_1[i]) | (label_0[i] ^ label_2[i]) | (label_0[i] ^ label_3[i]);
    }
    if (differ == 0) continue;
    std::int32_t least_difference[kBlock];
    std::fill_n(least_difference, kBlock, 3 * 255 + 1);
    for (const Labelled& labelled : choice) {
      const Colors& colors = labelled.color;
      std::int32_t difference[kBlock];
      for (int i = 0; i < kBlock; ++i) {
        difference[i] = std::abs(pixels.b[x + i] - colors.b[x + i]) + std::abs(pixels.g[x + i] - colors.g[x + i]) +
                        std::abs(pixels.r[x + i] - colors.r[x + i]);
      }
      for (int i = 0; i < kBlock; i += kLanes) {
        const IntLanes own = loadLanes(difference + i), least = loadLanes(least_difference + i);
        const IntLanes is_less = own < least;
        storeLanes(is_less ? loadLanes(labelled.label + x + i) : loadLanes(out + x + i), out + x + i);
        storeLanes(is_less ? own : least, least_difference + i);
      }
    }
  }
}

/// Writes each value of a row twice, and to `beside` the one before it first, then the one after it.
template <typename Value, typename At>
void widen(int values, const At& at, std::vector<Value>& own, std::vector<Value>& beside) {
  for (int x = 0; x < values; ++x) {
    const auto left = 2 * static_cast<std::size_t>(x);
    own[left] = own[left + 1] = at(x);
    beside[left] = at(std::max(0, x - 1));
    beside[left + 1] = at(std::min(values - 1, x + 1));
  }
}

Colors colorsOf(const std::array<std::vector<std::uint8_t>, 3>& channels) {
  return {channels[0].data(), channels[1].data(), channels[2].data()};
}

}  // namespace

const cv::Mat3b& LabelUpsampler::halve(const cv::Mat3b& image) {
  half_.create((image.rows + 1) / 2, (image.cols + 1) / 2);
  const int pairs = image.cols / 2;
  for (int y = 0; y < half_.rows; ++y) {
    const cv::Vec3b *above = image[2 * y], *below = image[std::min(2 * y + 1, image.rows - 1)];
    meanOfRows(above->val, below->val, pairs, half_[y]->val);
    if (pairs == half_.cols) continue;
    for (int c = 0; c < 3; ++c) {
      half_(y, pairs)[c] = static_cast<std::uint8_t>((above[image.cols - 1][c] + below[image.cols - 1][c] + 1) / 2);
    }
  }
  return half_;
}

void LabelUpsampler::upsample(const Segmentation& half, const cv::Mat3b& image, Segmentation& result) {
  constexpr int kUnnumbered = -1;
  resize(image.cols);
  numbers_.assign(static_cast<std::size_t>(half.count), kUnnumbered);
  result.count = 0;
  result.labels.create(image.size());
  std::array<std::uint8_t*, 3> split{split_[0].data(), split_[1].data(), split_[2].data()};
  for (int y = 0; y < image.rows; ++y) {
    const int row = y / 2, next = std::clamp(y % 2 == 0 ? row - 1 : row + 1, 0, half_.rows - 1);
    const WideRow &own = widened(half.labels, row), &beyond = widened(half.labels, next);
    cv::hal::split8u(image.ptr(y), split.data(), image.cols, 3);
    chooseLabels(colorsOf(split_),
                 {{{colorsOf(own.own_color), own.own_label.data()},
                   {colorsOf(own.beside_color), own.beside_label.data()},
                   {colorsOf(beyond.own_color), beyond.own_label.data()},
                   {colorsOf(beyond.beside_color), beyond.beside_label.data()}}},
                 static_cast<int>(chosen_.size()), chosen_.data());
    for (int x = 0; x < image.cols; ++x) {
      int& number = numbers_[static_cast<std::size_t>(chosen_[static_cast<std::size_t>(x)])];
      if (number == kUnnumbered) number = result.count++;
      result.labels(y, x) = number;
    }
  }
}

void LabelUpsampler::resize(int width) {
  const std::size_t length = padded(width);
  for (WideRow& wide : rows_) {
    wide.row = -1;
    for (auto* channels : {&wide.own_color, &wide.beside_color}) {
      for (std::vector<std::uint8_t>& channel : *channels) channel.resize(length);
    }
    wide.own_label.resize(length);
    wide.beside_label.resize(length);
  }
  for (std::vector<std::uint8_t>& channel : split_) channel.resize(length);
  chosen_.resize(length);
}

/// From the ring, or made in the place of one that is no longer needed.
const LabelUpsampler::WideRow& LabelUpsampler::widened(const cv::Mat1i& half_labels, int row) {
  WideRow& wide = rows_[static_cast<std::size_t>(row) % rows_.size()];
  if (wide.row == row) return wide;
  wide.row = row;
  const cv::Vec3b* colors = half_[row];
  const int* labels = half_labels[row];
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    widen(
        half_.cols, [&](int x) { return colors[x][c]; }, wide.own_color[channel], wide.beside_color[channel]);
  }
  widen(
      half_.cols, [&](int x) { return labels[x]; }, wide.own_label, wide.beside_label);
  return wide;
}

}  // namespace saccade
