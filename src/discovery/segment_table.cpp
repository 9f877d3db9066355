#include "saccade/discovery/segment_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/lanes.hpp"
#include "discovery/row_sums.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

// Two pixels this far apart in depth, at 1 m, lie on different surfaces; the noise of structured light grows with z².
constexpr float kDepthStep_m = 0.010F;
constexpr float kDepthStepPerSquareMetre = 0.006F;
// Points for hulls and samples are taken from every second column and row.
constexpr int kPointStep = 2;

struct Directions {
  std::array<float, SegmentTable::kDirections> x, y, z;
};

// Spread evenly over the sphere by the golden angle.
Directions makeDirections() {
  Directions directions{};
  const double golden_angle = 2.399963229728653;
  for (std::size_t i = 0; i < SegmentTable::kDirections; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / SegmentTable::kDirections;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = golden_angle * static_cast<double>(i);
    directions.x[i] = static_cast<float>(radius * std::cos(angle));
    directions.y[i] = static_cast<float>(radius * std::sin(angle));
    directions.z[i] = static_cast<float>(z);
  }
  return directions;
}

// Takes the measured points of every second column of a run into a segment's extremes, eight directions at a time.
SACCADE_MULTIVERSION void extend(SegmentTable::Extremes& extremes, const Directions& directions,
                                 const cv::Vec3f* vertices, int begin_u, int end_u) {
  for (std::size_t d = 0; d < SegmentTable::kDirections; d += kLanes) {
    const FloatLanes x = loadLanes(&directions.x[d]), y = loadLanes(&directions.y[d]), z = loadLanes(&directions.z[d]);
    FloatLanes reach = loadLanes(&extremes.reach[d]);
    IntLanes farthest = IntLanes{} - 1;
    for (int u = begin_u; u < end_u; u += kPointStep) {
      const cv::Vec3f& p = vertices[u];
      if (!(p[2] > 0.0F)) continue;
      const FloatLanes own = x * p[0] + y * p[1] + z * p[2];
      const IntLanes is_farther = own > reach;
      farthest = is_farther ? IntLanes{} + u : farthest;
      reach = is_farther ? own : reach;
    }
    if (!any(farthest >= 0)) continue;
    storeLanes(reach, &extremes.reach[d]);
    std::array<std::int32_t, kLanes> columns;
    storeLanes(farthest, columns.data());
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (columns[i] < 0) continue;
      const cv::Vec3f& p = vertices[columns[i]];
      extremes.x[d + i] = p[0];
      extremes.y[d + i] = p[1];
      extremes.z[d + i] = p[2];
    }
  }
}

// Mean absolute difference of the channels, 0..1.
inline float colorStep(const cv::Vec3b& a, const cv::Vec3b& b) {
  const int sum = std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
  return static_cast<float>(sum) * (1.0F / 765.0F);
}

void requireSize(const char* what, cv::Size found, cv::Size expected) {
  if (found == expected) return;
  throw std::invalid_argument(std::string("SegmentTable: the ") + what + " has " + std::to_string(found.width) + "x" +
                              std::to_string(found.height) + " pixels, the segmentation " +
                              std::to_string(expected.width) + "x" + std::to_string(expected.height));
}

}  // namespace

RawMoments& RawMoments::operator+=(const RawMoments& other) {
  m00 += other.m00;
  m10 += other.m10;
  m01 += other.m01;
  m20 += other.m20;
  m11 += other.m11;
  m02 += other.m02;
  m30 += other.m30;
  m21 += other.m21;
  m12 += other.m12;
  m03 += other.m03;
  return *this;
}

SegmentSums& SegmentSums::operator+=(const SegmentSums& other) {
  if (other.area == 0) return *this;
  if (area == 0) {
    *this = other;
    return *this;
  }
  area += other.area;
  min_u = std::min(min_u, other.min_u);
  min_v = std::min(min_v, other.min_v);
  max_u = std::max(max_u, other.max_u);
  max_v = std::max(max_v, other.max_v);
  moments += other.moments;
  saliency += other.saliency;
  for (std::size_t i = 0; i < 3; ++i) color[i] += other.color[i];
  color_squared += other.color_squared;
  depth_count += other.depth_count;
  for (std::size_t i = 0; i < 3; ++i) vertex[i] += other.vertex[i];
  for (std::size_t i = 0; i < 6; ++i) scatter[i] += other.scatter[i];
  normal_count += other.normal_count;
  for (std::size_t i = 0; i < 3; ++i) normal[i] += other.normal[i];
  return *this;
}

void SegmentTable::build(const Segmentation& segmentation, const cv::Mat1f& saliency, const cv::Mat3b& color,
                         const DepthMaps* depth) {
  build({{this, &segmentation}}, saliency, color, depth);
}

void SegmentTable::build(std::initializer_list<Building> tables, const cv::Mat1f& saliency, const cv::Mat3b& color,
                         const DepthMaps* depth) {
  for (const auto& [table, segmentation] : tables) {
    const cv::Size size = segmentation->labels.size();
    requireSize("saliency map", saliency.size(), size);
    requireSize("colour image", color.size(), size);
    if (depth != nullptr) requireSize("vertex map", depth->vertices.size(), size);
    if (depth != nullptr) requireSize("normal map", depth->normals.size(), size);
    table->begin(*segmentation, depth != nullptr);
  }
  std::vector<double>& row_sums = tables.begin()->first->row_sums_;
  row_sums.resize(static_cast<std::size_t>(color.cols + 1) * kRowSums);
  for (int v = 0; v < color.rows; ++v) {
    sumRow(v, saliency, color, depth, row_sums.data());
    for (const auto& [table, segmentation] : tables) table->addRow(*segmentation, v, row_sums);
  }
  for (const auto& [table, segmentation] : tables) {
    if (depth != nullptr) {
      table->gatherPoints(segmentation->labels, *depth);
    } else {
      table->sample_count_.assign(table->sums_.size(), 0);
    }
    table->gatherCracks(segmentation->labels, color, depth);
    table->sortEdges();
  }
}

void SegmentTable::begin(const Segmentation& segmentation, bool has_depth) {
  size_ = segmentation.labels.size();
  has_depth_ = has_depth;
  sums_.assign(static_cast<std::size_t>(segmentation.count), SegmentSums{});
  for (std::vector<std::int64_t>* power : {&power_1_, &power_2_, &power_3_}) {
    power->assign(static_cast<std::size_t>(size_.width) + 1, 0);
  }
  for (int u = 0; u < size_.width; ++u) {
    const auto i = static_cast<std::size_t>(u);
    const std::int64_t x = u - momentOrigin().x;
    power_1_[i + 1] = power_1_[i] + x;
    power_2_[i + 1] = power_2_[i] + x * x;
    power_3_[i + 1] = power_3_[i] + x * x * x;
  }
}

void SegmentTable::addRow(const Segmentation& segmentation, int v, const std::vector<double>& row_sums) {
  const int* row = segmentation.labels[v];
  for (int u = 0; u < size_.width;) {
    const int begin = u, label = row[u];
    while (u < size_.width && row[u] == label) ++u;
    if (label >= segmentation.count) {
      throw std::invalid_argument("SegmentTable: label " + std::to_string(label) + " where there are " +
                                  std::to_string(segmentation.count) + " segments");
    }
    if (label >= 0) addRun(sums_[static_cast<std::size_t>(label)], v, begin, u, row_sums);
  }
}

void SegmentTable::addRun(SegmentSums& sums, int v, int begin_u, int end_u, const std::vector<double>& row_sums) const {
  const auto begin = static_cast<std::size_t>(begin_u), end = static_cast<std::size_t>(end_u);
  if (sums.area == 0) {
    sums.min_u = begin_u;
    sums.min_v = v;
    sums.max_u = end_u - 1;
  }
  sums.area += end_u - begin_u;
  sums.min_u = std::min(sums.min_u, begin_u);
  sums.max_u = std::max(sums.max_u, end_u - 1);
  sums.max_v = v;

  const std::int64_t y = v - momentOrigin().y, n = end_u - begin_u;
  const std::int64_t x1 = power_1_[end] - power_1_[begin], x2 = power_2_[end] - power_2_[begin],
                     x3 = power_3_[end] - power_3_[begin];
  sums.moments += {n, x1, n * y, x2, x1 * y, n * y * y, x3, x2 * y, x1 * y * y, n * y * y * y};

  std::array<double, kRowSums> own;
  const double *left = row_sums.data() + begin * kRowSums, *right = row_sums.data() + end * kRowSums;
  for (std::size_t i = 0; i < kRowSums; ++i) own[i] = right[i] - left[i];
  sums.saliency += own[kRowSaliency];
  for (std::size_t i = 0; i < 3; ++i) sums.color[i] += own[kRowColor + i];
  sums.color_squared += own[kRowColorSquared];
  if (!has_depth_) return;
  for (std::size_t i = 0; i < 3; ++i) sums.vertex[i] += own[kRowVertex + i];
  for (std::size_t i = 0; i < 3; ++i) sums.normal[i] += own[kRowNormal + i];
  for (std::size_t i = 0; i < 6; ++i) sums.scatter[i] += own[kRowScatter + i];
  sums.depth_count += static_cast<int>(own[kRowDepthCount]);
  sums.normal_count += static_cast<int>(own[kRowNormalCount]);
}

// Keeps about every n-th point, at irregular steps lest they fall into step with the image's columns; when the
// segment's places are full, every second one is dropped and n doubles.
void SegmentTable::addSample(std::size_t segment, const Eigen::Vector3f& point) {
  if (--sample_wait_[segment] > 0) return;
  Eigen::Vector3f* const samples = samples_.data() + segment * kMaxSamples;
  int& count = sample_count_[segment];
  if (count == static_cast<int>(kMaxSamples)) {
    for (std::size_t i = 0; i < kMaxSamples / 2; ++i) samples[i] = samples[2 * i];
    count = static_cast<int>(kMaxSamples) / 2;
    sample_stride_[segment] *= 2;
  }
  samples[count++] = point;
  std::uint32_t& random = sample_random_[segment];
  random = random * 1664525U + 1013904223U;
  const auto stride = static_cast<std::uint32_t>(sample_stride_[segment]);
  sample_wait_[segment] = static_cast<int>(1 + (random >> 8) % (2 * stride - 1));
}

void SegmentTable::gatherPoints(const cv::Mat1i& labels, const DepthMaps& depth) {
  static const Directions directions = makeDirections();
  Extremes none{};
  none.reach.fill(-std::numeric_limits<float>::infinity());
  extremes_.assign(sums_.size(), none);
  samples_.resize(sums_.size() * kMaxSamples);
  sample_count_.assign(sums_.size(), 0);
  sample_stride_.assign(sums_.size(), 1);
  sample_wait_.assign(sums_.size(), 1);
  sample_random_.assign(sums_.size(), 1);
  for (int v = 0; v < labels.rows; v += kPointStep) {
    const int* row = labels[v];
    const cv::Vec3f* vertices = depth.vertices[v];
    for (int u = 0; u < labels.cols;) {
      const int begin = u, label = row[u];
      while (u < labels.cols && row[u] == label) u += kPointStep;
      if (label < 0) continue;
      const auto segment = static_cast<std::size_t>(label);
      extend(extremes_[segment], directions, vertices, begin, u);
      for (int i = begin; i < u; i += kPointStep) {
        const cv::Vec3f& p = vertices[i];
        if (p[2] > 0.0F) addSample(segment, {p[0], p[1], p[2]});
      }
    }
  }
}

SegmentTable::EdgeSlot& SegmentTable::edgeSlot(std::int32_t a, std::int32_t b) {
  // Ids start at -2; the shift keeps 0 free for "empty". The first of the pair is the smaller id.
  const auto low = static_cast<std::uint64_t>(std::min(a, b) + 3),
             high = static_cast<std::uint64_t>(std::max(a, b) + 3);
  const std::uint64_t key = low << 32 | high;
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 40) & mask;
  while (slots_[i].key != key) {
    if (slots_[i].key == 0) {
      slots_[i].key = key;
      ++used_slots_;
      break;
    }
    i = (i + 1) & mask;
  }
  return slots_[i];
}

void SegmentTable::growEdgeSlots() {
  std::vector<EdgeSlot> old(slots_.size() * 2);
  old.swap(slots_);
  used_slots_ = 0;
  for (const EdgeSlot& slot : old) {
    if (slot.key == 0) continue;
    const auto a = static_cast<std::int32_t>(slot.key >> 32) - 3,
               b = static_cast<std::int32_t>(slot.key & 0xFFFFFFFFU) - 3;
    edgeSlot(a, b) = slot;
  }
}

void SegmentTable::gatherCracks(const cv::Mat1i& labels, const cv::Mat3b& color, const DepthMaps* depth) {
  if (slots_.empty()) slots_.resize(4096);
  std::fill(slots_.begin(), slots_.end(), EdgeSlot{});
  used_slots_ = 0;
  EdgeSlot* last = nullptr;  // cracks of one boundary mostly follow each other
  int last_a = 0, last_b = 0;
  const auto add = [&](int a, int b, int u_a, int v_a, int u_b, int v_b) {
    if (last == nullptr || a != last_a || b != last_b) {
      if (used_slots_ * 2 > slots_.size()) growEdgeSlots();
      last = &edgeSlot(a, b);
      last_a = a;
      last_b = b;
    }
    EdgeSlot& slot = *last;
    ++slot.length;
    slot.color_step += colorStep(color(v_a, u_a), color(v_b, u_b));
    if (depth == nullptr) return;
    const float z_a = depth->vertices(v_a, u_a)[2], z_b = depth->vertices(v_b, u_b)[2];
    if (!(z_a > 0.0F) || !(z_b > 0.0F)) return;
    ++slot.known;
    const float nearest = std::min(z_a, z_b), step = kDepthStep_m + kDepthStepPerSquareMetre * nearest * nearest;
    const bool a_first = a < b;
    if (z_b - z_a > step) ++(a_first ? slot.first_nearer : slot.second_nearer);
    if (z_a - z_b > step) ++(a_first ? slot.second_nearer : slot.first_nearer);
  };
  const auto addBorder = [&](int label, int cracks) {
    if (label < 0) return;
    if (used_slots_ * 2 > slots_.size()) growEdgeSlots();
    edgeSlot(kImageBorder, label).length += cracks;
    last = nullptr;  // the table may have moved
  };
  for (int v = 0; v < labels.rows; ++v) {
    const int* row = labels[v];
    const int* above = v > 0 ? labels[v - 1] : nullptr;
    addBorder(row[0], 1);
    addBorder(row[labels.cols - 1], 1);
    for (int u = 1; u < labels.cols; ++u) {
      if (row[u] != row[u - 1]) add(row[u - 1], row[u], u - 1, v, u, v);
    }
    if (above == nullptr) continue;
    for (int u = 0; u < labels.cols; ++u) {
      if (row[u] != above[u]) add(above[u], row[u], u, v - 1, u, v);
    }
  }
  if (labels.rows == 0) return;
  for (int u = 0; u < labels.cols; ++u) {
    addBorder(labels(0, u), 1);
    addBorder(labels(labels.rows - 1, u), 1);
  }
}

void SegmentTable::sortEdges() {
  edge_begin_.assign(sums_.size() + 1, 0);
  const auto forEachSide = [&](const auto& visit) {
    for (const EdgeSlot& slot : slots_) {
      if (slot.key == 0) continue;
      const auto a = static_cast<std::int32_t>(slot.key >> 32) - 3,
                 b = static_cast<std::int32_t>(slot.key & 0xFFFFFFFFU) - 3;
      const auto step = static_cast<double>(slot.color_step);
      if (a >= 0) visit(a, SegmentEdge{b, slot.length, slot.known, slot.first_nearer, slot.second_nearer, step});
      if (b >= 0) visit(b, SegmentEdge{a, slot.length, slot.known, slot.second_nearer, slot.first_nearer, step});
    }
  };
  forEachSide([&](std::int32_t segment, const SegmentEdge&) { ++edge_begin_[static_cast<std::size_t>(segment) + 1]; });
  for (std::size_t i = 1; i < edge_begin_.size(); ++i) edge_begin_[i] += edge_begin_[i - 1];
  edges_.resize(edge_begin_.back());
  std::vector<std::size_t> next(edge_begin_.begin(), edge_begin_.end() - 1);
  forEachSide(
      [&](std::int32_t segment, const SegmentEdge& edge) { edges_[next[static_cast<std::size_t>(segment)]++] = edge; });
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    std::sort(edges_.begin() + static_cast<std::ptrdiff_t>(edge_begin_[s]),
              edges_.begin() + static_cast<std::ptrdiff_t>(edge_begin_[s + 1]),
              [](const SegmentEdge& a, const SegmentEdge& b) { return a.neighbor < b.neighbor; });
  }
}

}  // namespace saccade
