#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace saccade {

/// Convex hull of points in space, made point by point (the incremental algorithm, de Berg et al. 2008, ch. 11) with a
/// tolerance that follows the points' extent.
///
/// Made for a few dozen points, as candidates have: each point is held against the planes of all faces at once, and
/// only where it sees one the hull is opened. build() recycles all buffers; a hull of 30 points takes about 5 µs.
class ConvexHull {
 public:
  struct Face {
    std::array<int, 3> vertices{};   ///< indices into the points given, counter-clockwise seen from outside
    std::array<int, 3> neighbors{};  ///< indices of the faces behind the edges from vertex i to vertex i + 1
    Eigen::Vector3d normal;          ///< unit, outwards
    double offset = 0.0;             ///< normal · p = offset on the face
  };

  /// Makes the hull of `points` (finite). Returns the dimension of what they span: 3 if there is a hull, else 2 (flat),
  /// 1 (on a line), 0 (one point) or -1 (no point), and there are no faces. Points nearer than the tolerance to the
  /// hull may stay outside it by that much.
  int build(std::span<const Eigen::Vector3f> points);

  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  /// Distance below which points count as equal, collinear or coplanar; unit of the points.
  [[nodiscard]] double tolerance() const { return tolerance_; }

 private:
  /// A triangle of the growing hull; its plane is kept in `planes_` under the same index.
  struct Triangle {
    std::array<int, 3> vertices{};
    std::array<int, 3> neighbors{};  ///< behind the edge from vertex i to vertex i + 1
  };
  struct HorizonEdge {
    int from = 0, to = 0, behind = 0;  ///< behind: the triangle that stays
  };
  struct Ordered {
    double distance_squared = 0.0;  ///< from the points' middle
    int point = 0;
  };
  /// Planes of the triangles, coordinate by coordinate: normals (of any length), offsets, and offsets plus tolerance,
  /// beyond which a point sees the triangle. The limit of a triangle that is gone is infinite.
  struct Planes {
    std::vector<double> x, y, z, offset, limit;
  };

  [[nodiscard]] int firstTetrahedron(std::array<int, 4>& corners);
  void sortOutermostFirst();
  [[nodiscard]] int newPlace();
  void setTriangle(int place, int a, int b, int c);
  void addPoint(int point);
  void collectHorizon(int first_seen);
  [[nodiscard]] bool orderHorizon();
  void closeHorizon(int point);
  void collectFaces();

  std::vector<Eigen::Vector3d> points_;
  std::vector<Ordered> order_;
  double tolerance_ = 0.0;
  std::vector<Triangle> triangles_;
  std::size_t used_ = 0;  ///< places of `triangles_` that hold one or did so
  Planes planes_;
  std::vector<std::int64_t> sees_;  ///< per triangle: not 0 if the point at hand sees it
  std::vector<int> seen_, free_;    ///< places: of the triangles seen, and of those that are gone
  std::vector<HorizonEdge> horizon_, ordered_horizon_;
  std::vector<int> edge_from_;  ///< per point: the horizon's edge that begins there
  std::vector<int> made_;       ///< places of the triangles that close the horizon
  std::vector<int> face_at_;    ///< per place: index of its face
  std::vector<Face> faces_;
};

}  // namespace saccade
