#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace saccade {

/// Convex hull of points in space, by quickhull (Barber et al. 1996) with a tolerance that follows the points' extent.
///
/// build() recycles all buffers; a hull of 30 points takes about 10 µs.
class ConvexHull {
 public:
  struct Face {
    std::array<int, 3> vertices{};  ///< indices into the points given, counter-clockwise seen from outside
    Eigen::Vector3d normal;         ///< unit, outwards
    double offset = 0.0;            ///< normal · p = offset on the face
  };

  /// Makes the hull of `points` (finite). Returns the dimension of what they span: 3 if there is a hull, else 2 (flat),
  /// 1 (on a line), 0 (one point) or -1 (no point), and there are no faces. Points nearer than the tolerance to the
  /// hull may stay outside it by that much.
  int build(std::span<const Eigen::Vector3f> points);

  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }
  /// Distance below which points count as equal, collinear or coplanar; unit of the points.
  [[nodiscard]] double tolerance() const { return tolerance_; }

 private:
  struct WorkFace {
    Face face;
    std::array<int, 3> neighbors{};  ///< behind the edge from vertex i to vertex i + 1
    std::vector<int> outside;        ///< points that see this face and no face before it
    int farthest = -1;
    double farthest_distance = 0.0;
    bool removed = false;
    int visited = 0;
  };
  struct HorizonEdge {
    int from = 0, to = 0, behind = 0;  ///< behind: the face that stays
  };

  [[nodiscard]] int firstTetrahedron(std::array<int, 4>& corners);
  int addFace(int a, int b, int c);
  void giveToFaces(const std::vector<int>& points, int first_face);
  void collectHorizon(int face, int point);
  bool addPoint(int face);

  std::vector<Eigen::Vector3d> points_;
  double tolerance_ = 0.0;
  std::vector<WorkFace> work_;
  std::size_t used_ = 0;
  std::vector<int> visible_, orphans_;
  std::vector<HorizonEdge> horizon_;
  std::vector<std::array<int, 2>> stack_;
  int round_ = 0;
  std::vector<Face> faces_;
};

}  // namespace saccade
