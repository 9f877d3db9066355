#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "saccade/core/config_fields.hpp"
#include "saccade/map/ior_map.hpp"

namespace saccade {

struct MapDifferenceConfig {
  int tolerance_leaves = 2;  ///< a surface that moved no farther is the same surface, measured again
  int least_leaves = 20;     ///< smaller changes are noise
  double least_likeness = 0.5;

  void describe(ConfigVisitor& v) {
    v.integer("tolerance_leaves", tolerance_leaves, {0, 16}, "leaves", "surfaces that near each other are the same");
    v.integer("least_leaves", least_leaves, {1, 1000000}, "leaves", "smaller changes are left out");
    v.number("least_likeness", least_likeness, {0.0, 1.0}, "",
             "likeness of what is gone and what appeared, to be one thing that moved");
  }
};

/// Connected leaves that are occupied in one map and free in the other.
struct ChangedRegion {
  std::vector<LeafKey> leaves;  ///< sorted
  Eigen::AlignedBox3d box_W;    ///< metres
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_bgr = Eigen::Vector3d::Zero();  ///< of the leaves whose colour is known
};

/// A region that is gone in one place and appeared in another.
struct MovedRegion {
  std::size_t gone = 0, appeared = 0;  ///< indices in MapDifference
  double likeness = 0.0;               ///< of size and colour, 0..1
};

/// What is different in a later map B of the scene of an earlier one, A. Unknown is neither occupied nor free: what
/// only one map has seen has not changed.
struct MapDifference {
  std::vector<ChangedRegion> appeared;  ///< occupied in B, free in A; the largest first
  std::vector<ChangedRegion> gone;      ///< occupied in A, free in B; the largest first
  std::vector<MovedRegion> moved;       ///< pairs of these, the most alike first; each region at most once

  std::size_t same = 0;    ///< leaves occupied in A with a surface of B near by
  std::size_t only_a = 0;  ///< occupied in A, unknown in B
  std::size_t only_b = 0;  ///< occupied in B, unknown in A

  std::vector<LeafKey> attention_gained;         ///< occupied in B with more IOR weight than in A
  std::size_t inhibited_a = 0, inhibited_b = 0;  ///< leaves
  std::size_t attended_a = 0, attended_b = 0;    ///< leaves with any IOR weight
};

/// Compares two maps of one world frame and leaf size (see resampleMap()). Deterministic. Cost: every leaf, and the
/// neighbourhood of what differs. Throws std::invalid_argument for maps whose leaves differ in size.
[[nodiscard]] MapDifference compareMaps(const IorMap& a, const IorMap& b, const MapDifferenceConfig& config = {});

}  // namespace saccade
