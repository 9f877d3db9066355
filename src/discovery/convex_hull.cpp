#include "saccade/discovery/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <Eigen/Geometry>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

// Float input carries a relative error of 6e-8 per coordinate; a few of them add up in a plane's equation.
constexpr double kRelativeTolerance = 5e-7;
constexpr std::size_t kQuad = 4;  // planes looked at together; arrays are padded to it
constexpr double kNever = std::numeric_limits<double>::infinity();

using Quad = double __attribute__((vector_size(32)));
using QuadBits = std::int64_t __attribute__((vector_size(32)));

SACCADE_INLINE Quad loadQuad(const double* from) {
  Quad quad;
  std::memcpy(&quad, from, sizeof quad);
  return quad;
}

// Marks the planes beyond whose limit a point lies; tells whether there is one.
SACCADE_MULTIVERSION bool markSeen(const double* nx, const double* ny, const double* nz, const double* limit,
                                   std::size_t count, double x, double y, double z, std::int64_t* sees) {
  QuadBits any = {};
  for (std::size_t i = 0; i < count; i += kQuad) {
    const QuadBits beyond = loadQuad(nx + i) * x + loadQuad(ny + i) * y + loadQuad(nz + i) * z > loadQuad(limit + i);
    std::memcpy(sees + i, &beyond, sizeof beyond);
    any |= beyond;
  }
  return (any[0] | any[1] | any[2] | any[3]) != 0;
}

}  // namespace

int ConvexHull::build(std::span<const Eigen::Vector3f> points) {
  faces_.clear();
  points_.clear();
  for (const Eigen::Vector3f& point : points) points_.push_back(point.cast<double>());
  if (points_.empty()) return -1;

  std::array<int, 4> corners{};
  const int dimension = firstTetrahedron(corners);
  if (dimension < 3) return dimension;
  const auto at = [this](int i) -> const Eigen::Vector3d& { return points_[static_cast<std::size_t>(i)]; };
  auto [a, b, c, d] = corners;
  if ((at(b) - at(a)).cross(at(c) - at(a)).dot(at(d) - at(a)) > 0.0) std::swap(b, c);  // d lies behind abc

  used_ = 0;
  free_.clear();
  const std::array<std::array<int, 3>, 4> first{{{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}}};
  const std::array<std::array<int, 3>, 4> beside{{{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const int place = newPlace();
    setTriangle(place, first[i][0], first[i][1], first[i][2]);
    triangles_[i].neighbors = beside[i];
  }
  edge_from_.assign(points_.size(), 0);
  sortOutermostFirst();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    // A corner must not be taken twice, though by rounding it may seem to see a sliver; equal points are in a row.
    const int point = order_[i].point;
    if (point == a || point == b || point == c || point == d) continue;
    if (i > 0 && at(point) == at(order_[i - 1].point)) continue;
    addPoint(point);
  }
  collectFaces();
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

// Points far from the middle first: a hull that is large early makes few triangles that do not last, and none between
// points on one line, whose planes would be rounding alone.
void ConvexHull::sortOutermostFirst() {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points_) middle += point;
  middle /= static_cast<double>(points_.size());
  order_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    order_.push_back({(points_[i] - middle).squaredNorm(), static_cast<int>(i)});
  }
  std::sort(order_.begin(), order_.end(), [](const Ordered& a, const Ordered& b) {
    return a.distance_squared != b.distance_squared ? a.distance_squared > b.distance_squared : a.point < b.point;
  });
}

// A place whose plane no point sees yet; one that is free before a new one.
int ConvexHull::newPlace() {
  if (!free_.empty()) {
    const int place = free_.back();
    free_.pop_back();
    return place;
  }
  if (used_ == triangles_.size()) {
    triangles_.resize(used_ + kQuad);
    for (std::vector<double>* plane : {&planes_.x, &planes_.y, &planes_.z, &planes_.offset}) {
      plane->resize(triangles_.size(), 0.0);
    }
    planes_.limit.resize(triangles_.size(), kNever);
    sees_.resize(triangles_.size(), 0);
  }
  // The last places of the quad may hold planes of an earlier hull.
  if (used_ % kQuad == 0) std::fill_n(planes_.limit.begin() + static_cast<std::ptrdiff_t>(used_), kQuad, kNever);
  return static_cast<int>(used_++);
}

void ConvexHull::setTriangle(int place, int a, int b, int c) {
  const auto i = static_cast<std::size_t>(place);
  const Eigen::Vector3d &p = points_[static_cast<std::size_t>(a)], &q = points_[static_cast<std::size_t>(b)],
                        &r = points_[static_cast<std::size_t>(c)];
  const Eigen::Vector3d normal = (q - p).cross(r - p);
  triangles_[i].vertices = {a, b, c};
  planes_.x[i] = normal.x();
  planes_.y[i] = normal.y();
  planes_.z[i] = normal.z();
  planes_.offset[i] = normal.dot(p + q + r) / 3.0;
  planes_.limit[i] = planes_.offset[i] + tolerance_ * normal.norm();
}

// Takes a point into the hull if it lies outside. It is left out if the horizon is not one simple loop, which only
// rounding can bring about.
void ConvexHull::addPoint(int point) {
  const Eigen::Vector3d& p = points_[static_cast<std::size_t>(point)];
  if (!markSeen(planes_.x.data(), planes_.y.data(), planes_.z.data(), planes_.limit.data(), used_, p.x(), p.y(), p.z(),
                sees_.data())) {
    return;
  }
  const auto first = std::find_if(sees_.begin(), sees_.end(), [](std::int64_t seen) { return seen != 0; });
  collectHorizon(static_cast<int>(first - sees_.begin()));
  if (orderHorizon()) closeHorizon(point);
}

// Walks over the triangles that the point sees, from neighbour to neighbour, and collects the edges where the seeing
// ends.
void ConvexHull::collectHorizon(int first_seen) {
  constexpr std::int64_t kVisited = 1;
  horizon_.clear();
  seen_.assign(1, first_seen);
  sees_[static_cast<std::size_t>(first_seen)] = kVisited;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Triangle& triangle = triangles_[static_cast<std::size_t>(seen_[i])];
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const int next = triangle.neighbors[edge];
      std::int64_t& sees = sees_[static_cast<std::size_t>(next)];
      if (sees == 0) {
        horizon_.push_back({triangle.vertices[edge], triangle.vertices[(edge + 1) % 3], next});
      } else if (sees != kVisited) {
        sees = kVisited;
        seen_.push_back(next);
      }
    }
  }
}

// Puts the horizon's edges head to tail; false if they are not one simple loop.
bool ConvexHull::orderHorizon() {
  for (std::size_t i = 0; i < horizon_.size(); ++i) {
    edge_from_[static_cast<std::size_t>(horizon_[i].from)] = static_cast<int>(i);
  }
  ordered_horizon_.clear();
  if (horizon_.size() < 3) return false;
  HorizonEdge edge = horizon_[0];
  do {
    ordered_horizon_.push_back(edge);
    const auto next = static_cast<std::size_t>(edge_from_[static_cast<std::size_t>(edge.to)]);
    if (next >= horizon_.size() || horizon_[next].from != edge.to) return false;
    edge = horizon_[next];
  } while (edge.from != horizon_[0].from && ordered_horizon_.size() < horizon_.size());
  return edge.from == horizon_[0].from && ordered_horizon_.size() == horizon_.size();
}

// Replaces the triangles seen by those between the horizon and the point.
void ConvexHull::closeHorizon(int point) {
  for (const int gone : seen_) {
    planes_.limit[static_cast<std::size_t>(gone)] = kNever;
    free_.push_back(gone);
  }
  const std::size_t count = ordered_horizon_.size();
  made_.clear();
  for (const HorizonEdge& edge : ordered_horizon_) {
    made_.push_back(newPlace());
    setTriangle(made_.back(), edge.from, edge.to, point);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const HorizonEdge& edge = ordered_horizon_[i];
    triangles_[static_cast<std::size_t>(made_[i])].neighbors = {edge.behind, made_[(i + 1) % count],
                                                                made_[(i + count - 1) % count]};
    Triangle& behind = triangles_[static_cast<std::size_t>(edge.behind)];
    for (std::size_t k = 0; k < 3; ++k) {
      if (behind.vertices[k] == edge.to && behind.vertices[(k + 1) % 3] == edge.from) behind.neighbors[k] = made_[i];
    }
  }
}

void ConvexHull::collectFaces() {
  face_at_.resize(used_);
  for (std::size_t i = 0; i < used_; ++i) {
    if (planes_.limit[i] == kNever) continue;
    const Eigen::Vector3d normal(planes_.x[i], planes_.y[i], planes_.z[i]);
    const double length = normal.norm(), scale = length > 0.0 ? 1.0 / length : 0.0;
    face_at_[i] = static_cast<int>(faces_.size());
    faces_.push_back({triangles_[i].vertices, triangles_[i].neighbors, normal * scale, planes_.offset[i] * scale});
  }
  for (Face& face : faces_) {
    for (int& neighbor : face.neighbors) neighbor = face_at_[static_cast<std::size_t>(neighbor)];
  }
}

}  // namespace saccade
