#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "saccade/discovery/convex_hull.hpp"

namespace saccade {

/// The paper's 3D convexity measure κ (equations 1 and 2, after Potapova et al. 2014).
///
/// Owns scratch memory only. Not thread-safe; one per thread.
class ConvexityMeasure {
 public:
  /// A face counts as seen if the cosine of the angle between its normal and the line of sight is larger than this.
  /// The sides of what a camera sees are made by its own lines of sight, so faces seen edge-on are not surface.
  static constexpr double kEdgeOnCosine = 0.05;

  /// Returns κ in metres: the weighted mean over `points` of the shortest distance to the faces of `hull` that the
  /// camera, at the origin of frame C, sees from outside. Low means convex. `weights` has one entry per point.
  /// If the hull has no face that is seen (flat objects, or the camera inside the hull) κ is 0. Exact to 1e-6 of the
  /// hull's extent.
  [[nodiscard]] double compute(const ConvexHull& hull, std::span<const Eigen::Vector3f> hull_points,
                               std::span<const Eigen::Vector3f> points, std::span<const float> weights);

 private:
  /// A visible face: its plane, and what parts its inside from that of its neighbours. About the hull's centre.
  struct VisibleFace {
    std::array<float, 3> normal;
    float offset;
    std::array<std::array<float, 3>, 3> inward;  ///< in the face's plane, across its edges
    std::array<float, 3> edge_offset;            ///< inward · p on the edge
  };
  /// An edge of visible faces, from `start` along `way`.
  struct VisibleEdge {
    std::array<float, 3> start, way;
    float inverse_length_squared;
  };
  friend struct ConvexityLanes;

  void gatherVisible(const ConvexHull& hull, std::span<const Eigen::Vector3f> hull_points,
                     const Eigen::Vector3d& centre);

  std::vector<VisibleFace> faces_;
  std::vector<VisibleEdge> edges_;
  std::vector<char> is_visible_;             ///< per face of the hull
  std::vector<float> x_, y_, z_, distance_;  ///< per point, padded to whole lanes
};

/// Distance of `p` from the triangle abc, its inside included.
[[nodiscard]] double distanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                        const Eigen::Vector3d& c);

}  // namespace saccade
