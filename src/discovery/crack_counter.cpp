#include "saccade/discovery/crack_counter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <opencv2/core/hal/hal.hpp>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

// Two pixels this far apart in depth, at 1 m, lie on different surfaces; the noise of structured light grows with z².
constexpr float kDepthStep_m = 0.010F;
constexpr float kDepthStepPerSquareMetre = 0.006F;

constexpr std::int32_t kEmpty = -1;
constexpr std::int32_t kNobody = -2;  // no label
constexpr std::size_t kFirstPlaces = 4096;

SACCADE_MULTIVERSION void addDifferences(const std::uint8_t* first, const std::uint8_t* second, int count,
                                         std::uint16_t* sums) {
  for (int u = 0; u < count; ++u) sums[u] = static_cast<std::uint16_t>(sums[u] + std::abs(first[u] - second[u]));
}

SACCADE_MULTIVERSION void compareDepths(const float* first, const float* second, int count, std::uint8_t* steps) {
  for (int u = 0; u < count; ++u) {
    const float a = first[u], b = second[u], nearest = std::min(a, b);
    const float step = kDepthStep_m + kDepthStepPerSquareMetre * nearest * nearest;
    const int known = nearest > 0.0F ? 1 : 0;
    const int further = b - a > step ? kFirstNearer - kNoStep : a - b > step ? kSecondNearer - kNoStep : 0;
    steps[u] = static_cast<std::uint8_t>(known * (kNoStep + further));
  }
}

}  // namespace

void PixelSteps::begin(const cv::Mat3b& color, const DepthMaps* depth) {
  color_ = &color;
  depth_ = depth;
  row_ = -1;
  const auto width = static_cast<std::size_t>(color.cols);
  for (Pixels* pixels : {&pixels_, &pixels_above_}) {
    for (std::vector<std::uint8_t>& channel : pixels->color) channel.resize(width);
    pixels->z_m.resize(width);
  }
  for (Row* row : {&beside_, &above_}) {
    row->color.resize(width);
    row->depth.assign(width, kUnknownDepth);
  }
}

void PixelSteps::nextRow() {
  ++row_;
  std::swap(pixels_, pixels_above_);
  const int width = color_->cols;
  std::array<std::uint8_t*, 3> channels{pixels_.color[0].data(), pixels_.color[1].data(), pixels_.color[2].data()};
  cv::hal::split8u(color_->ptr(row_), channels.data(), width, 3);
  if (depth_ != nullptr) {
    const cv::Vec3f* vertices = depth_->vertices[row_];
    for (int u = 0; u < width; ++u) pixels_.z_m[static_cast<std::size_t>(u)] = vertices[u][2];
  }
  compare(pixels_, pixels_, 1, width - 1, beside_);
  if (row_ > 0) compare(pixels_above_, pixels_, 0, width, above_);
}

/// Compares `count` pixels with those `offset` columns on in the other row.
void PixelSteps::compare(const Pixels& first, const Pixels& second, int offset, int count, Row& steps) const {
  std::fill(steps.color.begin(), steps.color.end(), std::uint16_t{0});
  for (std::size_t c = 0; c < 3; ++c) {
    addDifferences(first.color[c].data(), second.color[c].data() + offset, count, steps.color.data());
  }
  if (depth_ != nullptr) compareDepths(first.z_m.data(), second.z_m.data() + offset, count, steps.depth.data());
}

void CrackCounter::begin(int segments) {
  const auto labels = static_cast<std::size_t>(segments) + 1;
  pairs_.clear();
  if (places_.empty()) places_.resize(kFirstPlaces);
  std::fill(places_.begin(), places_.end(), kEmpty);
  recent_beside_.assign(labels, {kNobody, 0});
  recent_below_.assign(labels, {kNobody, 0});
  border_.assign(labels, 0);
}

void CrackCounter::addRow(const LabelRuns& runs, int v, const PixelSteps& steps) {
  const std::span<const LabelRun> row = runs.row(v);
  for (std::size_t i = 0; i + 1 < row.size(); ++i) {
    count(row[i].label, row[i + 1].label, steps.beside(), row[i].end_u - 1, row[i].end_u, recent_beside_);
  }
  const auto addBorder = [&](std::int32_t label, int cracks) {
    border_[static_cast<std::size_t>(label) + 1] += cracks;
  };
  addBorder(row.front().label, 1);
  addBorder(row.back().label, 1);
  for (const int end : {0, runs.rows() - 1}) {
    if (v != end) continue;
    int begin = 0;
    for (const LabelRun& run : row) {
      addBorder(run.label, run.end_u - begin);
      begin = run.end_u;
    }
  }
  if (v == 0) return;
  forEachCommonRun(runs.row(v - 1), row, [&](int begin, int end, std::int32_t above, std::int32_t below) {
    if (above != below) count(above, below, steps.above(), begin, end, recent_below_);
  });
}

void CrackCounter::count(std::int32_t a, std::int32_t b, const PixelSteps::Row& steps, int begin, int end,
                         std::vector<Recent>& recent) {
  Pair& pair = pairs_[pairOf(a, b, recent)];
  const int swapped = a < b ? 0 : kFirstNearer ^ kSecondNearer;
  for (auto u = static_cast<std::size_t>(begin); u < static_cast<std::size_t>(end); ++u) {
    const int step = steps.depth[u];
    ++pair.cracks[static_cast<std::size_t>(step >= kFirstNearer ? step ^ swapped : step)];
    pair.color += steps.color[u];
  }
}

std::size_t CrackCounter::pairOf(std::int32_t a, std::int32_t b, std::vector<Recent>& recent) {
  Recent& last = recent[static_cast<std::size_t>(a) + 1];
  if (last.other != b) last = {b, static_cast<std::int32_t>(findPair(a, b))};
  return static_cast<std::size_t>(last.pair);
}

/// The pair's index, a new one if it was not met yet.
std::size_t CrackCounter::findPair(std::int32_t a, std::int32_t b) {
  if (2 * pairs_.size() >= places_.size()) growPlaces();
  const std::int32_t first = std::min(a, b), second = std::max(a, b);
  std::int32_t& place = places_[placeOf(first, second)];
  if (place == kEmpty) {
    place = static_cast<std::int32_t>(pairs_.size());
    pairs_.push_back({first, second, {}, 0});
  }
  return static_cast<std::size_t>(place);
}

/// Where the pair's index stands, or would.
std::size_t CrackCounter::placeOf(std::int32_t first, std::int32_t second) const {
  const std::uint64_t key = static_cast<std::uint64_t>(first + 1) << 32 | static_cast<std::uint64_t>(second + 1);
  const std::size_t mask = places_.size() - 1;
  std::size_t i = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 32) & mask;
  while (places_[i] != kEmpty) {
    const Pair& pair = pairs_[static_cast<std::size_t>(places_[i])];
    if (pair.first == first && pair.second == second) break;
    i = (i + 1) & mask;
  }
  return i;
}

void CrackCounter::growPlaces() {
  places_.assign(2 * places_.size(), kEmpty);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    places_[placeOf(pairs_[i].first, pairs_[i].second)] = static_cast<std::int32_t>(i);
  }
}

}  // namespace saccade
