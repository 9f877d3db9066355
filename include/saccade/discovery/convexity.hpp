#pragma once

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
  /// If the hull has no face that is seen (flat objects, or the camera inside the hull) κ is 0.
  [[nodiscard]] double compute(const ConvexHull& hull, std::span<const Eigen::Vector3f> hull_points,
                               std::span<const Eigen::Vector3f> points, std::span<const float> weights);

 private:
  [[nodiscard]] double distanceToVisible(const Eigen::Vector3d& p);

  struct Triangle {
    Eigen::Vector3d a, b, c;
  };
  std::vector<Triangle> visible_;
  std::vector<double> normal_x_, normal_y_, normal_z_, offset_, plane_distance_;
};

/// Distance of `p` from the triangle abc, its inside included.
[[nodiscard]] double distanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                        const Eigen::Vector3d& c);

}  // namespace saccade
