#include "saccade/discovery/candidate_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr double kSmallestHu = 1e-10;
// A neighbour counts as going on where we end if the contrast to it is less than this: weak edges of one printed thing
// lie below, those between things mostly above.
constexpr double kOpenContrast = 0.08;
// The weakest neighbour is sought among those that share at least this part of the outline.
constexpr double kNeighborShare = 0.08;

// How clearly two segments part along `edge`: mean colour step, and share of depth steps in the same units.
double edgeContrast(const SegmentEdge& edge) {
  const double steps = edge.known > 0 ? static_cast<double>(edge.nearer + edge.farther) / edge.known : 0.0;
  return edge.color_step / edge.length + 0.3 * steps;
}

// Where `segment` reaches farther it becomes the owner.
SACCADE_MULTIVERSION void keepFarthest(const float* own, std::int32_t segment, float* reach, std::int32_t* owner) {
  for (std::size_t d = 0; d < SegmentTable::kDirections; ++d) {
    const bool is_farther = own[d] > reach[d];
    owner[d] = is_farther ? segment : owner[d];
    reach[d] = is_farther ? own[d] : reach[d];
  }
}

}  // namespace

double signedLog(double h) {
  return std::copysign(std::log10(1.0 + std::abs(h) / kSmallestHu), h);
}

std::array<double, 7> huMoments(const RawMoments& m) {
  const auto m00 = static_cast<double>(m.m00);
  const double x = static_cast<double>(m.m10) / m00, y = static_cast<double>(m.m01) / m00;
  const auto m20 = static_cast<double>(m.m20), m11 = static_cast<double>(m.m11), m02 = static_cast<double>(m.m02);
  const auto m10 = static_cast<double>(m.m10), m01 = static_cast<double>(m.m01);
  const double mu20 = m20 - x * m10, mu11 = m11 - x * m01, mu02 = m02 - y * m01;
  const double mu30 = static_cast<double>(m.m30) - x * (3.0 * mu20 + x * m10);
  const double mu21 = static_cast<double>(m.m21) - x * (2.0 * mu11 + x * m01) - y * mu20;
  const double mu12 = static_cast<double>(m.m12) - y * (2.0 * mu11 + y * m10) - x * mu02;
  const double mu03 = static_cast<double>(m.m03) - y * (3.0 * mu02 + y * m01);
  const double scale_2 = 1.0 / (m00 * m00), scale_3 = scale_2 / std::sqrt(m00);
  const double n20 = mu20 * scale_2, n11 = mu11 * scale_2, n02 = mu02 * scale_2, n30 = mu30 * scale_3,
               n21 = mu21 * scale_3, n12 = mu12 * scale_3, n03 = mu03 * scale_3;

  const double t0 = n30 + n12, t1 = n21 + n03, q0 = t0 * t0, q1 = t1 * t1;
  const double s = n20 + n02, d = n20 - n02, e = n30 - 3.0 * n12, f = 3.0 * n21 - n03, n4 = 4.0 * n11;
  const double a = q0 - 3.0 * q1, b = 3.0 * q0 - q1;
  return {s,
          d * d + n4 * n11,
          e * e + f * f,
          q0 + q1,
          e * t0 * a + f * t1 * b,
          d * (q0 - q1) + n4 * t0 * t1,
          f * t0 * a - e * t1 * b};
}

CandidateMeasurer::CandidateMeasurer(FeatureConfig config) : config_(config) {
  requireValid(config_);
}

void CandidateMeasurer::measure(std::span<Candidate> candidates, const Perception& seen) {
  measureAllButConvexity(candidates, seen);
  for (Candidate& candidate : candidates) {
    if (candidate.has_depth) measureConvexity(candidate, seen);
  }
}

void CandidateMeasurer::measureConvexity(Candidate& candidate, const Perception& seen) {
  candidate.features[kFeatureConvexity] = static_cast<float>(convexity(candidate, seen.table(candidate.source)));
  candidate.has_convexity = true;
}

void CandidateMeasurer::measureAllButConvexity(std::span<Candidate> candidates, const Perception& seen) {
  surface_structure_.assign(static_cast<std::size_t>(seen.surface_segments.count()), 0.0);
  for (std::int32_t i = 0; i < seen.surface_segments.count(); ++i) {
    if (seen.planes.planeOf(i) != SupportPlanes::kNoPlane) surface_structure_[static_cast<std::size_t>(i)] = 1.0;
  }
  color_structure_.assign(static_cast<std::size_t>(seen.color_segments.count()), 0.0);
  for (std::int32_t i = 0; i < seen.color_segments.count(); ++i) {
    double pixels = 0.0;
    for (const SegmentOverlap::Share& share : seen.overlap.ofFirst(i)) {
      pixels += share.pixels * surface_structure_[static_cast<std::size_t>(share.other)];
    }
    color_structure_[static_cast<std::size_t>(i)] = pixels / seen.color_segments.sums(i).area;
  }
  for (Candidate& candidate : candidates) measureOne(candidate, seen);
}

void CandidateMeasurer::measureOne(Candidate& candidate, const Perception& seen) {
  const SegmentTable& table = seen.table(candidate.source);
  SegmentSums sums;
  for (const std::int32_t segment : candidate.segments) sums += table.sums(segment);
  candidate.features.fill(0.0F);
  candidate.cues.fill(0.0F);
  candidate.has_depth = candidate.has_convexity = false;
  if (sums.area == 0) return;

  const double area = sums.area, image_area = seen.imageSize().area();
  candidate.has_depth = seen.has_depth && sums.depth_count >= std::max(1.0, config_.min_depth_share * area);
  const int perimeter = measureOutline(seen, sums, candidate);

  auto& features = candidate.features;
  const std::array<double, 7> hu = huMoments(sums.moments);
  for (std::size_t i = 0; i < hu.size(); ++i) features[kFeatureHu1 + i] = static_cast<float>(signedLog(hu[i]));
  features[kFeatureArea] = static_cast<float>(area / image_area);
  features[kFeatureSaliency] = static_cast<float>(sums.saliency / area);
  features[kFeaturePerimeter] = static_cast<float>(perimeter / image_area);
  if (candidate.has_depth) {
    features[kFeatureDepth] = static_cast<float>(sums.vertex[2] / sums.depth_count / config_.max_range_m);
  }
  candidate.cues[kCueAgreement] = static_cast<float>(std::log1p(candidate.unions));
  candidate.cues[kCueStraddling] = static_cast<float>(straddling(candidate, seen));
  measureShape(seen, sums, perimeter, candidate);
}

// Superpixel straddling (Alexe et al. 2012) of masks: each segment of the other segmentation counts with what of it
// lies inside or outside, whichever is less. 0 where the mask is made of whole segments, as an object's is.
double CandidateMeasurer::straddling(const Candidate& candidate, const Perception& seen) {
  const bool is_color = candidate.source == CandidateSource::kColor;
  const SegmentTable& other = is_color ? seen.surface_segments : seen.color_segments;
  shared_pixels_.resize(std::max(shared_pixels_.size(), static_cast<std::size_t>(other.count())), 0);
  neighbors_.clear();
  for (const std::int32_t segment : candidate.segments) {
    for (const SegmentOverlap::Share& share :
         is_color ? seen.overlap.ofFirst(segment) : seen.overlap.ofSecond(segment)) {
      int& pixels = shared_pixels_[static_cast<std::size_t>(share.other)];
      if (pixels == 0) neighbors_.push_back(share.other);
      pixels += share.pixels;
    }
  }
  double straddling = 0.0;
  for (const std::int32_t segment : neighbors_) {
    int& pixels = shared_pixels_[static_cast<std::size_t>(segment)];
    straddling += std::min(pixels, other.sums(segment).area - pixels);
    pixels = 0;
  }
  return straddling / candidate.area;
}

// The farthest points of all segments together; one point may be there several times.
void CandidateMeasurer::gatherExtremes(std::span<const std::int32_t> segments, const SegmentTable& table) {
  constexpr std::size_t kDirections = SegmentTable::kDirections;
  std::array<float, kDirections> reach;
  std::array<std::int32_t, kDirections> owner;
  reach.fill(-std::numeric_limits<float>::infinity());
  owner.fill(-1);
  for (const std::int32_t segment : segments) {
    keepFarthest(table.extremes(segment).reach.data(), segment, reach.data(), owner.data());
  }
  hull_points_.clear();
  for (std::size_t d = 0; d < kDirections; ++d) {
    if (owner[d] < 0) continue;
    const SegmentTable::Extremes& extremes = table.extremes(owner[d]);
    const Eigen::Vector3f point(extremes.x[d], extremes.y[d], extremes.z[d]);
    // The next direction often has the same farthest point.
    if (hull_points_.empty() || hull_points_.back() != point) hull_points_.push_back(point);
  }
}

double CandidateMeasurer::convexity(const Candidate& candidate, const SegmentTable& table) {
  gatherExtremes(candidate.segments, table);
  if (hull_.build(hull_points_) < 3) return 0.0;

  // Few points of each segment if there are many segments: the sum is what costs.
  const std::size_t per_segment = std::max<std::size_t>(2, 48 / candidate.segments.size());
  points_.clear();
  weights_.clear();
  for (const std::int32_t segment : candidate.segments) {
    const std::span<const Eigen::Vector3f> samples = table.samples(segment);
    if (samples.empty()) continue;
    const std::size_t step = (samples.size() + per_segment - 1) / per_segment;
    const std::size_t taken = (samples.size() + step - 1) / step;
    for (std::size_t i = 0; i < samples.size(); i += step) {
      points_.push_back(samples[i]);
      weights_.push_back(static_cast<float>(table.sums(segment).depth_count) / static_cast<float>(taken));
    }
  }
  return convexity_.compute(hull_, hull_points_, points_, weights_);
}

// Returns the perimeter in cracks.
int CandidateMeasurer::measureOutline(const Perception& seen, const SegmentSums& sums, Candidate& candidate) {
  const SegmentTable& table = seen.table(candidate.source);
  const std::vector<double>& structure =
      candidate.source == CandidateSource::kColor ? color_structure_ : surface_structure_;
  is_member_.resize(static_cast<std::size_t>(std::max(table.count(), static_cast<int>(is_member_.size()))), 0);
  for (const std::int32_t segment : candidate.segments) is_member_[static_cast<std::size_t>(segment)] = 1;
  int length = 0, border = 0, nearer = 0, farther = 0, unknown = 0, to_segments = 0;
  double color_step = 0.0, saliency = 0.0, color = 0.0, support = 0.0, own_structure = 0.0;
  SegmentEdge inside;
  int open = 0;
  neighbors_.clear();
  neighbor_edges_.resize(is_member_.size());
  for (const std::int32_t segment : candidate.segments) {
    own_structure += structure[static_cast<std::size_t>(segment)] * table.sums(segment).area;
    for (const SegmentEdge& edge : table.edges(segment)) {
      if (edge.neighbor >= 0 && is_member_[static_cast<std::size_t>(edge.neighbor)] != 0) {
        inside.length += edge.length;
        inside.known += edge.known;
        inside.nearer += edge.nearer + edge.farther;
        inside.color_step += edge.color_step;
        continue;
      }
      length += edge.length;
      if (edge.neighbor == SegmentTable::kImageBorder) {
        border += edge.length;
        continue;
      }
      nearer += edge.nearer;
      farther += edge.farther;
      unknown += edge.length - edge.known;
      color_step += edge.color_step;
      if (edge.neighbor < 0) continue;
      if (edgeContrast(edge) < kOpenContrast) open += edge.length;
      SegmentEdge& shared = neighbor_edges_[static_cast<std::size_t>(edge.neighbor)];
      if (shared.length == 0) neighbors_.push_back(edge.neighbor);
      shared.length += edge.length;
      shared.known += edge.known;
      shared.nearer += edge.nearer + edge.farther;
      shared.color_step += edge.color_step;
      const SegmentSums& other = table.sums(edge.neighbor);
      double difference = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        difference += std::abs(other.color[c] / other.area - sums.color[c] / sums.area) / 765.0;
      }
      to_segments += edge.length;
      saliency += edge.length * other.saliency / other.area;
      color += edge.length * difference;
      support += edge.length * structure[static_cast<std::size_t>(edge.neighbor)];
    }
  }
  for (const std::int32_t segment : candidate.segments) is_member_[static_cast<std::size_t>(segment)] = 0;

  const double outline = std::max(1, length), inner = std::max(1, length - border);
  auto& cues = candidate.cues;
  cues[kCueImageBorder] = static_cast<float>(border / outline);
  cues[kCueNearer] = static_cast<float>(nearer / inner);
  cues[kCueFarther] = static_cast<float>(farther / inner);
  cues[kCueUnknownDepth] = static_cast<float>(unknown / inner);
  cues[kCueColorContrast] = static_cast<float>(color_step / inner);
  cues[kCueSupport] = static_cast<float>(support / inner);
  cues[kCueStructure] = static_cast<float>(own_structure / sums.area);
  cues[kCueOpenOutline] = static_cast<float>(open / inner);
  if (inside.length > 0) cues[kCueInnerContrast] = static_cast<float>(inside.color_step / inside.length);
  if (inside.known > 0) cues[kCueInnerSteps] = static_cast<float>(1.0 * inside.nearer / inside.known);
  cues[kCueWeakestNeighbor] = static_cast<float>(takeWeakestNeighbor(kNeighborShare * inner));
  if (to_segments > 0) {
    cues[kCueSaliencyContrast] = static_cast<float>(sums.saliency / sums.area - saliency / to_segments);
    cues[kCueColorNeighbours] = static_cast<float>(color / to_segments);
  }
  return length;
}

// The contrast to the most alike of the neighbours gathered that share at least `min_length` cracks, 1 if there is
// none; forgets the neighbours.
double CandidateMeasurer::takeWeakestNeighbor(double min_length) {
  double weakest = 1.0;
  for (const std::int32_t neighbor : neighbors_) {
    SegmentEdge& shared = neighbor_edges_[static_cast<std::size_t>(neighbor)];
    if (shared.length >= min_length) weakest = std::min(weakest, edgeContrast(shared));
    shared = {};
  }
  return weakest;
}

void CandidateMeasurer::measureShape(const Perception& seen, const SegmentSums& sums, int perimeter,
                                     Candidate& candidate) const {
  auto& cues = candidate.cues;
  const double area = sums.area, box_area = candidate.box.area();
  cues[kCueExtent] = static_cast<float>(area / box_area);
  cues[kCueAspect] = static_cast<float>(std::log(static_cast<double>(candidate.box.width) / candidate.box.height));
  cues[kCueBoxSize] = static_cast<float>(std::sqrt(box_area / seen.imageSize().area()));
  cues[kCueCompactness] = static_cast<float>(4.0 * std::numbers::pi * area / (1.0 * perimeter * perimeter));
  cues[kCueSegments] = static_cast<float>(std::log(static_cast<double>(candidate.segments.size())));
  double variance = sums.color_squared / area;
  for (const double channel : sums.color) variance -= channel / area * (channel / area);
  cues[kCueColorSpread] = static_cast<float>(std::sqrt(std::max(0.0, variance)) / 255.0);
  if (!candidate.has_depth) return;

  const double n = sums.depth_count;
  const Eigen::Vector3d mean = Eigen::Vector3d(sums.vertex[0], sums.vertex[1], sums.vertex[2]) / n;
  Eigen::Matrix3d covariance;
  covariance << sums.scatter[0], sums.scatter[1], sums.scatter[2], sums.scatter[1], sums.scatter[3], sums.scatter[4],
      sums.scatter[2], sums.scatter[4], sums.scatter[5];
  covariance = covariance / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  const Eigen::Vector3d spread = solver.computeDirect(covariance, Eigen::EigenvaluesOnly).eigenvalues();
  cues[kCueLength] = static_cast<float>(std::sqrt(std::max(0.0, spread[2])));
  cues[kCueBreadth] = static_cast<float>(std::sqrt(std::max(0.0, spread[1])));
  cues[kCueThickness] = static_cast<float>(std::sqrt(std::max(0.0, spread[0])));
  cues[kCueMetricSize] = static_cast<float>(mean.z() * std::sqrt(area / (seen.camera.fx * seen.camera.fy)));
  cues[kCueHeight] = static_cast<float>(seen.planes.height(mean));
}

}  // namespace saccade
