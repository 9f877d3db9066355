#include "saccade/discovery/convexity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {

/// Eight points at once against the visible faces and edges.
struct ConvexityLanes {
  using VisibleFace = ConvexityMeasure::VisibleFace;
  using VisibleEdge = ConvexityMeasure::VisibleEdge;

  /// The nearest point of a face lies inside it, straight below the point, or on an edge. The distance from the face's
  /// plane is never more: where no point is nearer to a plane than to the insides, edges need not be tried.
  SACCADE_MULTIVERSION static void computeDistances(const VisibleFace* faces, std::size_t face_count,
                                                    const VisibleEdge* edges, std::size_t edge_count, const float* px,
                                                    const float* py, const float* pz, std::size_t point_count,
                                                    float* distance) {
    for (std::size_t i = 0; i < point_count; i += kLanes) {
      const FloatLanes x = loadLanes(px + i), y = loadLanes(py + i), z = loadLanes(pz + i);
      FloatLanes squared = allLanes(std::numeric_limits<float>::max()), to_plane = squared;
      for (std::size_t k = 0; k < face_count; ++k) {
        const VisibleFace& f = faces[k];
        const auto along = [&](const std::array<float, 3>& way) { return x * way[0] + y * way[1] + z * way[2]; };
        const FloatLanes height = along(f.normal) - f.offset, height_squared = height * height;
        const IntLanes inside = (along(f.inward[0]) >= f.edge_offset[0]) & (along(f.inward[1]) >= f.edge_offset[1]) &
                                (along(f.inward[2]) >= f.edge_offset[2]);
        to_plane = least(to_plane, height_squared);
        squared = inside ? least(squared, height_squared) : squared;
      }
      if (any(to_plane < squared)) {
        for (std::size_t k = 0; k < edge_count; ++k) {
          const VisibleEdge& e = edges[k];
          const FloatLanes dx = x - e.start[0], dy = y - e.start[1], dz = z - e.start[2];
          const FloatLanes share = (dx * e.way[0] + dy * e.way[1] + dz * e.way[2]) * e.inverse_length_squared;
          const FloatLanes t = least(most(share, FloatLanes{}), allLanes(1.0F));
          const FloatLanes rx = dx - t * e.way[0], ry = dy - t * e.way[1], rz = dz - t * e.way[2];
          squared = least(squared, rx * rx + ry * ry + rz * rz);
        }
      }
      squareRoots(squared);
      storeLanes(squared, distance + i);
    }
  }
};

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

void ConvexityMeasure::gatherVisible(const ConvexHull& hull, std::span<const Eigen::Vector3f> hull_points,
                                     const Eigen::Vector3d& centre) {
  const auto floats = [](const Eigen::Vector3d& v) {
    return std::array<float, 3>{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
  };
  const auto at = [&](int i) -> Eigen::Vector3d {
    return hull_points[static_cast<std::size_t>(i)].cast<double>() - centre;
  };
  faces_.clear();
  edges_.clear();
  is_visible_.clear();
  for (const ConvexHull::Face& face : hull.faces()) {
    const Eigen::Vector3d middle = (at(face.vertices[0]) + at(face.vertices[1]) + at(face.vertices[2])) / 3.0 + centre;
    is_visible_.push_back(face.offset < 0.0 &&
                          face.offset * face.offset > kEdgeOnCosine * kEdgeOnCosine * middle.squaredNorm());
  }
  for (std::size_t i = 0; i < is_visible_.size(); ++i) {
    if (is_visible_[i] == 0) continue;
    const ConvexHull::Face& face = hull.faces()[i];
    VisibleFace& visible = faces_.emplace_back();
    visible.normal = floats(face.normal);
    visible.offset = static_cast<float>(face.offset - face.normal.dot(centre));
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d start = at(face.vertices[k]), way = at(face.vertices[(k + 1) % 3]) - start;
      const Eigen::Vector3d inward = face.normal.cross(way);
      visible.inward[k] = floats(inward);
      visible.edge_offset[k] = static_cast<float>(inward.dot(start));
      const auto neighbor = static_cast<std::size_t>(face.neighbors[k]);
      if (is_visible_[neighbor] != 0 && neighbor < i) continue;  // the edge is there already
      edges_.push_back({floats(start), floats(way), static_cast<float>(1.0 / way.squaredNorm())});
    }
  }
}

double ConvexityMeasure::compute(const ConvexHull& hull, std::span<const Eigen::Vector3f> hull_points,
                                 std::span<const Eigen::Vector3f> points, std::span<const float> weights) {
  if (hull.faces().empty() || points.empty()) return 0.0;
  const Eigen::Vector3f centre = points[0];  // any point near the hull makes the floats' errors those of its extent
  gatherVisible(hull, hull_points, centre.cast<double>());
  if (faces_.empty()) return 0.0;
  const std::size_t padded = (points.size() + kLanes - 1) / kLanes * kLanes;
  for (std::vector<float>* values : {&x_, &y_, &z_, &distance_}) values->resize(std::max(values->size(), padded), 0.0F);
  for (std::size_t i = 0; i < points.size(); ++i) {
    x_[i] = points[i].x() - centre.x();
    y_[i] = points[i].y() - centre.y();
    z_[i] = points[i].z() - centre.z();
  }
  ConvexityLanes::computeDistances(faces_.data(), faces_.size(), edges_.data(), edges_.size(), x_.data(), y_.data(),
                                   z_.data(), padded, distance_.data());
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += static_cast<double>(weights[i]) * static_cast<double>(distance_[i]);
    weight += static_cast<double>(weights[i]);
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

}  // namespace saccade
