#include "saccade/discovery/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace saccade {
namespace {

// Float input carries a relative error of 6e-8 per coordinate; a few of them add up in a plane's equation.
constexpr double kRelativeTolerance = 1e-6;

}  // namespace

int ConvexHull::build(std::span<const Eigen::Vector3f> points) {
  faces_.clear();
  used_ = 0;
  points_.clear();
  for (const Eigen::Vector3f& point : points) points_.push_back(point.cast<double>());
  if (points_.empty()) return -1;

  std::array<int, 4> corners{};
  const int dimension = firstTetrahedron(corners);
  if (dimension < 3) return dimension;
  const auto at = [this](int i) -> const Eigen::Vector3d& { return points_[static_cast<std::size_t>(i)]; };
  auto [a, b, c, d] = corners;
  if ((at(b) - at(a)).cross(at(c) - at(a)).dot(at(d) - at(a)) > 0.0) std::swap(b, c);  // d lies behind abc

  addFace(a, b, c);
  addFace(a, d, b);
  addFace(b, d, c);
  addFace(c, d, a);
  work_[0].neighbors = {1, 2, 3};
  work_[1].neighbors = {3, 2, 0};
  work_[2].neighbors = {1, 3, 0};
  work_[3].neighbors = {2, 1, 0};
  orphans_.resize(points_.size());
  std::iota(orphans_.begin(), orphans_.end(), 0);
  giveToFaces(orphans_, 0);
  for (std::size_t face = 0; face < used_; ++face) {  // faces are only ever added at the end
    while (!work_[face].removed && !work_[face].outside.empty()) {
      if (!addPoint(static_cast<int>(face))) break;
    }
  }
  for (std::size_t i = 0; i < used_; ++i) {
    if (!work_[i].removed) faces_.push_back(work_[i].face);
  }
  return 3;
}

// Two farthest points along an axis, the farthest from their line, the farthest from that plane.
int ConvexHull::firstTetrahedron(std::array<int, 4>& corners) {
  Eigen::Vector3d low = points_[0], high = points_[0];
  std::array<int, 3> low_at{}, high_at{};
  for (std::size_t i = 0; i < points_.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      if (points_[i][axis] < low[axis]) low[axis] = points_[i][axis], low_at[k] = static_cast<int>(i);
      if (points_[i][axis] > high[axis]) high[axis] = points_[i][axis], high_at[k] = static_cast<int>(i);
    }
  }
  const double reach = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  tolerance_ = kRelativeTolerance * reach;
  int widest = 0;
  (high - low).maxCoeff(&widest);
  if (high[widest] - low[widest] <= tolerance_) return 0;
  corners[0] = low_at[static_cast<std::size_t>(widest)];
  corners[1] = high_at[static_cast<std::size_t>(widest)];

  const auto farthest = [this](const auto& distance) {
    std::size_t best = 0;
    double best_distance = -1.0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double d = distance(points_[i]);
      if (d > best_distance) best = i, best_distance = d;
    }
    return std::pair{static_cast<int>(best), best_distance};
  };
  const Eigen::Vector3d a = points_[static_cast<std::size_t>(corners[0])],
                        b = points_[static_cast<std::size_t>(corners[1])];
  const Eigen::Vector3d line = (b - a).normalized();
  const auto [third, line_distance] = farthest([&](const Eigen::Vector3d& p) { return line.cross(p - a).norm(); });
  if (line_distance <= tolerance_) return 1;
  corners[2] = third;
  const Eigen::Vector3d normal = line.cross(points_[static_cast<std::size_t>(third)] - a).normalized();
  const auto [fourth, plane_distance] = farthest([&](const Eigen::Vector3d& p) { return std::abs(normal.dot(p - a)); });
  if (plane_distance <= tolerance_) return 2;
  corners[3] = fourth;
  return 3;
}

int ConvexHull::addFace(int a, int b, int c) {
  if (used_ == work_.size()) work_.emplace_back();
  WorkFace& face = work_[used_];
  const Eigen::Vector3d &p = points_[static_cast<std::size_t>(a)], &q = points_[static_cast<std::size_t>(b)],
                        &r = points_[static_cast<std::size_t>(c)];
  face.face.vertices = {a, b, c};
  face.face.normal = (q - p).cross(r - p).normalized();
  face.face.offset = face.face.normal.dot(p + q + r) / 3.0;
  face.outside.clear();
  face.farthest = -1;
  face.farthest_distance = 0.0;
  face.removed = false;
  face.visited = 0;
  return static_cast<int>(used_++);
}

void ConvexHull::giveToFaces(const std::vector<int>& points, int first_face) {
  for (const int point : points) {
    const Eigen::Vector3d& p = points_[static_cast<std::size_t>(point)];
    for (auto i = static_cast<std::size_t>(first_face); i < used_; ++i) {
      WorkFace& face = work_[i];
      const double distance = face.face.normal.dot(p) - face.face.offset;
      if (distance <= tolerance_) continue;
      face.outside.push_back(point);
      if (distance > face.farthest_distance) {
        face.farthest = point;
        face.farthest_distance = distance;
      }
      break;
    }
  }
}

// Walks over the faces that see the point, from face to neighbour, and collects the edges where the seeing ends.
void ConvexHull::collectHorizon(int face, int point) {
  const Eigen::Vector3d& p = points_[static_cast<std::size_t>(point)];
  ++round_;
  visible_.clear();
  horizon_.clear();
  visible_.push_back(face);
  work_[static_cast<std::size_t>(face)].visited = round_;
  for (std::size_t i = 0; i < visible_.size(); ++i) {
    const WorkFace& current = work_[static_cast<std::size_t>(visible_[i])];
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const int next = current.neighbors[edge];
      WorkFace& neighbor = work_[static_cast<std::size_t>(next)];
      if (neighbor.visited == round_) continue;
      if (neighbor.face.normal.dot(p) - neighbor.face.offset > tolerance_) {
        neighbor.visited = round_;
        visible_.push_back(next);
      }
    }
  }
  for (const int seen : visible_) {
    const WorkFace& current = work_[static_cast<std::size_t>(seen)];
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const int next = current.neighbors[edge];
      if (work_[static_cast<std::size_t>(next)].visited == round_) continue;
      horizon_.push_back({current.face.vertices[edge], current.face.vertices[(edge + 1) % 3], next});
    }
  }
}

// Takes the farthest point outside `face` into the hull. False (and the face gives up its points) if the horizon is
// not one simple loop, which only rounding can bring about.
bool ConvexHull::addPoint(int face) {
  const int point = work_[static_cast<std::size_t>(face)].farthest;
  collectHorizon(face, point);
  for (std::size_t i = 0; i + 1 < horizon_.size(); ++i) {  // puts the edges head to tail
    const auto next = std::find_if(horizon_.begin() + static_cast<std::ptrdiff_t>(i) + 1, horizon_.end(),
                                   [&](const HorizonEdge& edge) { return edge.from == horizon_[i].to; });
    if (next == horizon_.end()) {
      work_[static_cast<std::size_t>(face)].outside.clear();
      return false;
    }
    std::swap(horizon_[i + 1], *next);
  }
  if (horizon_.size() < 3 || horizon_.back().to != horizon_.front().from) {
    work_[static_cast<std::size_t>(face)].outside.clear();
    return false;
  }

  orphans_.clear();
  for (const int seen : visible_) {
    WorkFace& old = work_[static_cast<std::size_t>(seen)];
    old.removed = true;
    for (const int outside : old.outside) {
      if (outside != point) orphans_.push_back(outside);
    }
  }
  const auto first = static_cast<int>(used_), count = static_cast<int>(horizon_.size());
  for (int i = 0; i < count; ++i) {
    const HorizonEdge edge = horizon_[static_cast<std::size_t>(i)];
    const int made = addFace(edge.from, edge.to, point);
    work_[static_cast<std::size_t>(made)].neighbors = {edge.behind, first + (i + 1) % count,
                                                       first + (i + count - 1) % count};
    WorkFace& behind = work_[static_cast<std::size_t>(edge.behind)];
    for (std::size_t k = 0; k < 3; ++k) {
      if (behind.face.vertices[k] == edge.to && behind.face.vertices[(k + 1) % 3] == edge.from) {
        behind.neighbors[k] = made;
      }
    }
  }
  giveToFaces(orphans_, first);
  return true;
}

}  // namespace saccade
