#include "saccade/discovery/segment_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <tbb/parallel_invoke.h>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

// Points for hulls and samples are taken from every second column and row.
constexpr int kPointStep = 2;
// The largest colour difference across a crack, summed over the channels.
constexpr double kWholeColorStep = 3 * 255.0;

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

// Farthest points of a run, eight directions at a time, with the columns they are at.
struct RunReach {
  static constexpr std::size_t kGroups = SegmentTable::kDirections / kLanes;
  float reach[SegmentTable::kDirections];
  std::int32_t column[SegmentTable::kDirections];
};

// Finds the farthest of the measured points of every second column of a run; false if there is none.
SACCADE_MULTIVERSION bool findFarthest(const Directions& directions, const cv::Vec3f* vertices, int begin_u, int end_u,
                                       RunReach& found) {
  FloatLanes reach[RunReach::kGroups];
  IntLanes column[RunReach::kGroups];
  for (std::size_t g = 0; g < RunReach::kGroups; ++g) {
    reach[g] = allLanes(-std::numeric_limits<float>::infinity());
    column[g] = IntLanes{} - 1;
  }
  bool is_measured = false;
  for (int u = begin_u; u < end_u; u += kPointStep) {
    const cv::Vec3f& p = vertices[u];
    if (!(p[2] > 0.0F)) continue;
    is_measured = true;
    for (std::size_t g = 0; g < RunReach::kGroups; ++g) {
      const FloatLanes own = loadLanes(&directions.x[g * kLanes]) * p[0] + loadLanes(&directions.y[g * kLanes]) * p[1] +
                             loadLanes(&directions.z[g * kLanes]) * p[2];
      const IntLanes is_farther = own > reach[g];
      column[g] = is_farther ? IntLanes{} + u : column[g];
      reach[g] = is_farther ? own : reach[g];
    }
  }
  for (std::size_t g = 0; g < RunReach::kGroups; ++g) {
    storeLanes(reach[g], found.reach + g * kLanes);
    storeLanes(column[g], found.column + g * kLanes);
  }
  return is_measured;
}

// Takes the farthest points of a run into a segment's extremes.
SACCADE_MULTIVERSION void extend(SegmentTable::Extremes& extremes, const RunReach& found, const cv::Vec3f* vertices) {
  for (std::size_t d = 0; d < SegmentTable::kDirections; d += kLanes) {
    unsigned farther = bitsOf(loadLanes(found.reach + d) > loadLanes(&extremes.reach[d]));
    for (; farther != 0; farther &= farther - 1) {
      const std::size_t i = d + static_cast<std::size_t>(std::countr_zero(farther));
      const cv::Vec3f& p = vertices[found.column[i]];
      extremes.reach[i] = found.reach[i];
      extremes.x[i] = p[0];
      extremes.y[i] = p[1];
      extremes.z[i] = p[2];
    }
  }
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
  const Segmentation none{cv::Mat1i(segmentation.labels.size(), kUnsegmented), 0};
  SegmentTable unused;
  build(*this, segmentation, unused, none, saliency, color, depth);
}

void SegmentTable::build(SegmentTable& first, const Segmentation& of_first, SegmentTable& second,
                         const Segmentation& of_second, const cv::Mat1f& saliency, const cv::Mat3b& color,
                         const DepthMaps* depth) {
  const cv::Size size = of_first.labels.size();
  requireSize("other segmentation", of_second.labels.size(), size);
  requireSize("saliency map", saliency.size(), size);
  requireSize("colour image", color.size(), size);
  if (depth != nullptr) requireSize("vertex map", depth->vertices.size(), size);
  if (depth != nullptr) requireSize("normal map", depth->normals.size(), size);
  first.begin(of_first, depth != nullptr);
  second.begin(of_second, depth != nullptr);
  first.steps_.begin(color, depth);
  first.preparePixels();
  tbb::parallel_invoke(
      [&] {
        for (int v = 0; v < size.height; ++v) {
          first.common_runs_.clear();
          forEachCommonRun(first.runs_.row(v), second.runs_.row(v), [&](int, int end, std::int32_t a, std::int32_t b) {
            first.common_runs_.push_back({end, a + 1, b + 1});
          });
          addRuns(first.pixelRow(v, saliency, color, depth), first.common_runs_, first.added_.data(),
                  second.added_.data());
          if (depth != nullptr && v % kPointStep == 0) addPoints(first, second, depth->vertices[v]);
        }
      },
      [&] {
        for (int v = 0; v < size.height; ++v) {
          first.steps_.nextRow();
          for (SegmentTable* table : {&first, &second}) table->cracks_.addRow(table->runs_, v, first.steps_);
        }
      });
  for (SegmentTable* table : {&first, &second}) {
    table->takeSums();
    table->takeEdges();
  }
}

void SegmentTable::begin(const Segmentation& segmentation, bool has_depth) {
  size_ = segmentation.labels.size();
  has_depth_ = has_depth;
  runs_.build(segmentation);
  const auto count = static_cast<std::size_t>(segmentation.count);
  sums_.assign(count, SegmentSums{});
  added_.assign((count + 1) * kRunSums, 0.0);
  cracks_.begin(segmentation.count);
  Extremes none{};
  none.reach.fill(-std::numeric_limits<float>::infinity());
  extremes_.assign(has_depth ? count : 0, none);
  samples_.resize(count * kMaxSamples);
  sampling_.assign(count, Sampling{});
}

/// What pixelRow() hands out beside the images: powers of the columns, and rows of its own.
void SegmentTable::preparePixels() {
  const auto width = static_cast<std::size_t>(size_.width);
  column_powers_.assign(4 * (width + 1), 0.0);
  for (std::size_t u = 0; u < width; ++u) {
    const double x = static_cast<double>(u) - momentOrigin().x;
    const double powers[] = {1.0, x, x * x, x * x * x};
    for (std::size_t i = 0; i < 4; ++i) column_powers_[4 * (u + 1) + i] = column_powers_[4 * u + i] + powers[i];
  }
  padded_color_.resize(width + 1);
  padded_vertices_.assign(width + 2, cv::Vec3f());
  padded_normals_.assign(width + 2, cv::Vec3f());
}

/// Rows of the images; of the last one copies, as a little beyond its end may be read. Zeros without depth.
PixelRow SegmentTable::pixelRow(int v, const cv::Mat1f& saliency, const cv::Mat3b& color, const DepthMaps* depth) {
  PixelRow row{saliency[v],
               color[v],
               depth != nullptr ? depth->vertices[v] : padded_vertices_.data(),
               depth != nullptr ? depth->normals[v] : padded_normals_.data(),
               column_powers_.data(),
               static_cast<double>(v - momentOrigin().y)};
  if (v + 1 < size_.height) return row;
  const auto padded = [&](auto* pixels, auto& copy) {
    if (pixels != copy.data()) std::copy_n(pixels, size_.width, copy.begin());
    return copy.data();
  };
  row.color = padded(row.color, padded_color_);
  row.vertices = padded(row.vertices, padded_vertices_);
  row.normals = padded(row.normals, padded_normals_);
  return row;
}

/// Takes the points of the common runs into both tables' extremes and samples.
void SegmentTable::addPoints(SegmentTable& first, SegmentTable& second, const cv::Vec3f* vertices) {
  static const Directions directions = makeDirections();
  RunReach found;
  int begin = 0;
  for (const CommonRun& run : first.common_runs_) {
    const int from = (begin + kPointStep - 1) / kPointStep * kPointStep, end = run.end_u;
    begin = end;
    if (run.first + run.second == 0 || from >= end || !findFarthest(directions, vertices, from, end, found)) continue;
    for (const auto& [table, owner] : {std::pair{&first, run.first}, std::pair{&second, run.second}}) {
      if (owner == 0) continue;
      const auto segment = static_cast<std::size_t>(owner - 1);
      extend(table->extremes_[segment], found, vertices);
      for (int u = from; u < end; u += kPointStep) {
        const cv::Vec3f& p = vertices[u];
        if (p[2] > 0.0F) table->addSample(segment, {p[0], p[1], p[2]});
      }
    }
  }
}

// Keeps about every n-th point, at irregular steps lest they fall into step with the image's columns; when the
// segment's places are full, every second one is dropped and n doubles.
void SegmentTable::addSample(std::size_t segment, const Eigen::Vector3f& point) {
  Sampling& own = sampling_[segment];
  if (--own.wait > 0) return;
  Eigen::Vector3f* const samples = samples_.data() + segment * kMaxSamples;
  if (own.count == static_cast<int>(kMaxSamples)) {
    for (std::size_t i = 0; i < kMaxSamples / 2; ++i) samples[i] = samples[2 * i];
    own.count = static_cast<int>(kMaxSamples) / 2;
    own.stride *= 2;
  }
  samples[own.count++] = point;
  own.random = own.random * 1664525U + 1013904223U;
  own.wait = static_cast<int>(1 + (own.random >> 8) % (2 * static_cast<std::uint32_t>(own.stride) - 1));
}

/// Makes the segments' sums of what was added up.
void SegmentTable::takeSums() {
  for (int v = 0; v < size_.height; ++v) {
    int begin = 0;
    for (const LabelRun& run : runs_.row(v)) {
      const int begin_u = std::exchange(begin, run.end_u);
      if (run.label < 0) continue;
      SegmentSums& sums = sums_[static_cast<std::size_t>(run.label)];
      if (sums.max_u < 0) sums.min_u = begin_u, sums.min_v = v;
      sums.min_u = std::min(sums.min_u, begin_u);
      sums.max_u = std::max(sums.max_u, run.end_u - 1);
      sums.max_v = v;
    }
  }
  const auto whole = [](double value) { return static_cast<std::int64_t>(value); };
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    SegmentSums& sums = sums_[s];
    const double* const added = added_.data() + (s + 1) * kRunSums;
    const double* const m = added + kSumMoments;
    sums.area = static_cast<int>(m[0]);
    sums.moments = {whole(m[0]), whole(m[1]), whole(m[4]), whole(m[2]), whole(m[5]),
                    whole(m[8]), whole(m[3]), whole(m[6]), whole(m[9]), whole(m[12])};
    sums.saliency = added[kSumSaliency];
    std::copy_n(added + kSumColor, 3, sums.color.begin());
    sums.color_squared = added[kSumColorSquared];
    sums.depth_count = static_cast<int>(added[kSumDepthCount]);
    std::copy_n(added + kSumVertex, 3, sums.vertex.begin());
    std::copy_n(added + kSumScatter, 6, sums.scatter.begin());
    sums.normal_count = static_cast<int>(added[kSumNormalCount]);
    std::copy_n(added + kSumNormal, 3, sums.normal.begin());
  }
}

/// Gives each segment its edges, by rising neighbour.
void SegmentTable::takeEdges() {
  edge_begin_.assign(sums_.size() + 1, 0);
  const auto forEachSide = [&](const auto& visit) {
    for (const CrackCounter::Pair& pair : cracks_.pairs()) {
      const int known = pair.cracks[kNoStep] + pair.cracks[kFirstNearer] + pair.cracks[kSecondNearer];
      const int length = known + pair.cracks[kUnknownDepth];
      const double step = static_cast<double>(pair.color) / kWholeColorStep;
      const int nearer = pair.cracks[kFirstNearer], farther = pair.cracks[kSecondNearer];
      if (pair.first >= 0) visit(pair.first, SegmentEdge{pair.second, length, known, nearer, farther, step});
      if (pair.second >= 0) visit(pair.second, SegmentEdge{pair.first, length, known, farther, nearer, step});
    }
    for (std::int32_t s = 0; s < count(); ++s) {
      if (cracks_.border(s) > 0) visit(s, SegmentEdge{kImageBorder, cracks_.border(s), 0, 0, 0, 0.0});
    }
  };
  forEachSide([&](std::int32_t segment, const SegmentEdge&) { ++edge_begin_[static_cast<std::size_t>(segment) + 1]; });
  for (std::size_t i = 1; i < edge_begin_.size(); ++i) edge_begin_[i] += edge_begin_[i - 1];
  edges_.resize(edge_begin_.back());
  forEachSide([&](std::int32_t segment, const SegmentEdge& edge) {
    edges_[edge_begin_[static_cast<std::size_t>(segment)]++] = edge;  // moves every begin to its end
  });
  std::copy_backward(edge_begin_.begin(), edge_begin_.end() - 1, edge_begin_.end());
  edge_begin_[0] = 0;
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    std::sort(edges_.begin() + static_cast<std::ptrdiff_t>(edge_begin_[s]),
              edges_.begin() + static_cast<std::ptrdiff_t>(edge_begin_[s + 1]),
              [](const SegmentEdge& a, const SegmentEdge& b) { return a.neighbor < b.neighbor; });
  }
}

}  // namespace saccade
