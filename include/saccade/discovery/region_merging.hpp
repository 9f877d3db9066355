#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "saccade/discovery/segment_table.hpp"

namespace saccade {

/// What two neighbouring regions share; sums over the cracks between them.
struct SharedBoundary {
  int length = 0;
  int known = 0;            ///< cracks with depth on both sides
  int stepped = 0;          ///< of them: across a depth step
  double color_step = 0.0;  ///< sum of the colour differences across the cracks, each 0..1
};

/// Merges neighbouring segments pair by pair, always the most alike next, and reports each union on the way up.
///
/// The unions of n segments form a tree of at most n - 1 nodes, which holds most of the unions worth a candidate and
/// stays linear in n, where all unions of neighbours would not. Beyond the paper (grouping as in Uijlings et al.
/// 2013, over sums instead of pixels).
class RegionMerging {
 public:
  /// Unlikeness of two regions; the smallest merges first, infinity forbids. Must depend on its arguments only.
  using Unlikeness = std::function<double(const SegmentSums&, const SegmentSums&, const SharedBoundary&)>;
  /// Called with the rising ids of each union and its sums.
  using Report = std::function<void(std::span<const std::int32_t>, const SegmentSums&)>;

  /// Merges the segments whose entry in `active` is not 0 (one entry per segment) until no pair is left that may
  /// merge. Regions larger than `max_area` pixels are neither reported nor merged on. Ties: smaller ids first.
  void run(const SegmentTable& table, std::span<const std::uint8_t> active, int max_area, const Unlikeness& unlikeness,
           const Report& report);

 private:
  struct Link {
    std::int32_t region = 0;
    SharedBoundary boundary;
  };
  struct Region {
    bool alive = false;
    SegmentSums sums;
    std::vector<std::int32_t> segments;
    std::vector<Link> links;  ///< by rising region; those of dead regions are dropped when their successor comes
  };
  struct Step {
    double unlikeness = 0.0;
    std::int32_t a = 0, b = 0;
    bool operator>(const Step& other) const {
      if (unlikeness != other.unlikeness) return unlikeness > other.unlikeness;
      return a != other.a ? a > other.a : b > other.b;
    }
  };

  void push(std::int32_t a, std::int32_t b, const SharedBoundary& boundary, const Unlikeness& unlikeness);
  std::int32_t merge(std::int32_t a, std::int32_t b);

  std::vector<Region> regions_;
  std::size_t used_ = 0;
  std::vector<Step> steps_;  ///< a heap, the smallest on top
};

}  // namespace saccade
