#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/convex_hull.hpp"
#include "saccade/discovery/convexity.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

struct FeatureConfig {
  double max_range_m = 4.0;
  double min_depth_share = 0.2;

  void describe(ConfigVisitor& v) {
    v.number("max_range", max_range_m, {0.1, 1000.0}, "m", "range by which the mean depth is normalised");
    v.number("min_depth_share", min_depth_share, {0.0, 1.0}, "",
             "share of a candidate's pixels that must have depth; below, the ranker without depth judges it");
  }
};

/// Measures candidates: the paper's twelve features ("Ranking of the candidates") and our cues, from the sums of their
/// segments, without touching an image.
///
/// Owns scratch memory only. Not thread-safe; one per thread. About 10 µs a candidate, most of it the convex hull.
class CandidateMeasurer {
 public:
  explicit CandidateMeasurer(FeatureConfig config = {});

  /// Sets features, cues and has_depth of every candidate. The convexity κ is measured on the hull of the segments'
  /// extreme points, over a bounded number of points spread over the mask.
  void measure(std::span<Candidate> candidates, const Perception& seen);
  /// The same but for κ, which takes half of the time and stays 0.
  void measureAllButConvexity(std::span<Candidate> candidates, const Perception& seen);
  /// Sets κ of one of them that has depth.
  void measureConvexity(Candidate& candidate, const Perception& seen);

 private:
  void measureOne(Candidate& candidate, const Perception& seen);
  void gatherExtremes(std::span<const std::int32_t> segments, const SegmentTable& table);
  [[nodiscard]] double convexity(const Candidate& candidate, const SegmentTable& table);
  [[nodiscard]] double straddling(const Candidate& candidate, const Perception& seen);
  int measureOutline(const Perception& seen, const SegmentSums& sums, Candidate& candidate);
  [[nodiscard]] double takeWeakestNeighbor(double min_length);
  void measureShape(const Perception& seen, const SegmentSums& sums, int perimeter, Candidate& candidate) const;

  FeatureConfig config_;
  ConvexHull hull_;
  ConvexityMeasure convexity_;
  std::vector<Eigen::Vector3f> hull_points_, points_;
  std::vector<float> weights_;
  std::vector<std::uint8_t> is_member_;
  std::vector<std::int32_t> neighbors_;                      ///< of the candidate being measured
  std::vector<SegmentEdge> neighbor_edges_;                  ///< what it shares with each; all empty between candidates
  std::vector<int> shared_pixels_;                           ///< with the other source's segments; 0 between candidates
  std::vector<double> color_structure_, surface_structure_;  ///< of each segment: share that lies on a large plane
};

/// sign(h) log10(1 + |h| / 1e-10): the Hu moments span ten decades and both signs; this is their logarithm made
/// continuous at 0.
[[nodiscard]] double signedLog(double h);

/// The seven Hu moments of the pixels summed in `moments` (at least one pixel), as cv::HuMoments of their binary image.
[[nodiscard]] std::array<double, 7> huMoments(const RawMoments& moments);

}  // namespace saccade
