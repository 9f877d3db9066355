#include "saccade/discovery/convexity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

SACCADE_MULTIVERSION void planeDistances(const double* nx, const double* ny, const double* nz, const double* offset,
                                         std::size_t count, double x, double y, double z, double* distance) {
  for (std::size_t i = 0; i < count; ++i) distance[i] = std::abs(nx[i] * x + ny[i] * y + nz[i] * z - offset[i]);
}

}  // namespace

// Voronoi regions of the triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double distanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                          const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return ap.norm();
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return bp.norm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return (ap - ab * (d1 / (d1 - d3))).norm();
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return cp.norm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return (ap - ac * (d2 / (d2 - d6))).norm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return (bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))).norm();
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return std::min({ap.norm(), bp.norm(), cp.norm()});  // a triangle without area
  return (ap - ab * (vb / sum) - ac * (vc / sum)).norm();
}

// The distance from a face's plane is never more than that from the face: faces are tried by rising plane distance
// until no plane is nearer than the best face.
double ConvexityMeasure::distanceToVisible(const Eigen::Vector3d& p) {
  planeDistances(normal_x_.data(), normal_y_.data(), normal_z_.data(), offset_.data(), offset_.size(), p.x(), p.y(),
                 p.z(), plane_distance_.data());
  double best = std::numeric_limits<double>::infinity();
  while (true) {
    const auto nearest = std::min_element(plane_distance_.begin(), plane_distance_.end());
    if (!(*nearest < best)) return best;
    const Triangle& triangle = visible_[static_cast<std::size_t>(nearest - plane_distance_.begin())];
    best = std::min(best, distanceToTriangle(p, triangle.a, triangle.b, triangle.c));
    *nearest = std::numeric_limits<double>::infinity();
  }
}

double ConvexityMeasure::compute(const ConvexHull& hull, std::span<const Eigen::Vector3f> hull_points,
                                 std::span<const Eigen::Vector3f> points, std::span<const float> weights) {
  visible_.clear();
  normal_x_.clear();
  normal_y_.clear();
  normal_z_.clear();
  offset_.clear();
  const auto at = [&](int i) { return Eigen::Vector3d(hull_points[static_cast<std::size_t>(i)].cast<double>()); };
  for (const ConvexHull::Face& face : hull.faces()) {
    const Eigen::Vector3d centre = (at(face.vertices[0]) + at(face.vertices[1]) + at(face.vertices[2])) / 3.0;
    if (!(-face.offset > kEdgeOnCosine * centre.norm())) continue;
    visible_.push_back({at(face.vertices[0]), at(face.vertices[1]), at(face.vertices[2])});
    normal_x_.push_back(face.normal.x());
    normal_y_.push_back(face.normal.y());
    normal_z_.push_back(face.normal.z());
    offset_.push_back(face.offset);
  }
  if (visible_.empty() || points.empty()) return 0.0;
  plane_distance_.resize(visible_.size());
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += static_cast<double>(weights[i]) * distanceToVisible(points[i].cast<double>());
    weight += static_cast<double>(weights[i]);
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

}  // namespace saccade
