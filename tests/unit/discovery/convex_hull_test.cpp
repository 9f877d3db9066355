#include "saccade/discovery/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "saccade/discovery/convexity.hpp"

namespace saccade {
namespace {

// Points are floats of the order of 1 m; the hull's own tolerance is 5e-7 of that, and it may add up over two steps.
constexpr double kOutside_m = 1e-5;
// Promised by ConvexityMeasure for hulls of up to a metre: it works with floats about the hull.
constexpr double kDistance_m = 1e-6;

std::vector<Eigen::Vector3f> randomPoints(int count, std::mt19937& random, bool on_sphere) {
  std::normal_distribution<float> normal;
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3f p(normal(random), normal(random), normal(random));
    if (on_sphere) p.normalize();
    points.push_back(p);
  }
  return points;
}

void expectClosedAndOutside(const ConvexHull& hull, const std::vector<Eigen::Vector3f>& points) {
  std::map<std::pair<int, int>, int> edges;
  for (const ConvexHull::Face& face : hull.faces()) {
    EXPECT_NEAR(face.normal.norm(), 1.0, 1e-9);
    for (std::size_t i = 0; i < 3; ++i) ++edges[{face.vertices[i], face.vertices[(i + 1) % 3]}];
    for (const Eigen::Vector3f& point : points) {
      ASSERT_LE(face.normal.dot(point.cast<double>()) - face.offset, kOutside_m);
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ((edges.count({edge.second, edge.first})), 1U) << "an edge has a face on one side only";
  }
}

TEST(ConvexHull, OfACubeWithPointsInsideAndOnItsFacesCoversItsSixSides) {
  std::vector<Eigen::Vector3f> points;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 3; ++z)
        points.emplace_back(0.5F * static_cast<float>(x), 0.5F * static_cast<float>(y), 0.5F * static_cast<float>(z));
    }
  }
  ConvexHull hull;
  ASSERT_EQ(hull.build(points), 3);
  expectClosedAndOutside(hull, points);
  double area = 0.0;
  for (const ConvexHull::Face& face : hull.faces()) {
    const auto at = [&](std::size_t i) {
      return Eigen::Vector3d(points[static_cast<std::size_t>(face.vertices[i])].cast<double>());
    };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    EXPECT_NEAR(face.normal.cwiseAbs().maxCoeff(), 1.0, kOutside_m) << "a face that cuts a corner off";
    for (std::size_t k = 0; k < 3; ++k) {  // what it says of its neighbours
      const ConvexHull::Face& neighbor = hull.faces()[static_cast<std::size_t>(face.neighbors[k])];
      const auto& v = neighbor.vertices;
      EXPECT_NE(std::find(v.begin(), v.end(), face.vertices[k]), v.end());
      EXPECT_NE(std::find(v.begin(), v.end(), face.vertices[(k + 1) % 3]), v.end());
    }
  }
  EXPECT_NEAR(area, 6.0, kOutside_m);
}

TEST(ConvexHull, OfRandomPointsIsClosedAndHoldsThemAll) {
  std::mt19937 random(7);
  ConvexHull hull;
  for (int round = 0; round < 60; ++round) {
    const std::vector<Eigen::Vector3f> points = randomPoints(4 + round * 7, random, round % 2 == 0);
    ASSERT_EQ(hull.build(points), 3);
    expectClosedAndOutside(hull, points);
    // Euler: a closed triangle mesh has 2 n - 4 faces; on a sphere every point is a corner.
    if (round % 2 == 0) {
      EXPECT_EQ(hull.faces().size(), 2 * points.size() - 4);
    }
  }
}

TEST(ConvexHull, OfNearlyFlatAndGriddedPointsStaysClosed) {
  std::mt19937 random(3);
  ConvexHull hull;
  for (int round = 0; round < 30; ++round) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 80; ++i) {
      points.emplace_back(static_cast<float>(random() % 8) * 0.01F, static_cast<float>(random() % 8) * 0.01F,
                          1.0F + static_cast<float>(random() % 3) * 0.001F);
    }
    ASSERT_EQ(hull.build(points), 3);
    expectClosedAndOutside(hull, points);
  }
}

TEST(ConvexHull, NamesTheDimensionOfFlatSets) {
  ConvexHull hull;
  EXPECT_EQ(hull.build({}), -1);
  const std::vector<Eigen::Vector3f> point(5, {1.0F, 2.0F, 3.0F});
  EXPECT_EQ(hull.build(point), 0);
  std::vector<Eigen::Vector3f> line, plane;
  for (int i = 0; i < 10; ++i) {
    line.emplace_back(static_cast<float>(i), static_cast<float>(2 * i), 1.0F);
    plane.emplace_back(static_cast<float>(i % 4), static_cast<float>(i / 4), 2.0F);
  }
  EXPECT_EQ(hull.build(line), 1);
  EXPECT_EQ(hull.build(plane), 2);
  EXPECT_TRUE(hull.faces().empty());
}

TEST(Convexity, DistanceToATriangleEqualsTheSmallestOverAGridOnIt) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Eigen::Vector3d(uniform(random), uniform(random), uniform(random)); };
  for (int round = 0; round < 50; ++round) {
    const Eigen::Vector3d a = point(), b = point(), c = point(), p = 2.0 * point();
    double smallest = 1e9;
    constexpr int kSteps = 200;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Eigen::Vector3d q = a + (b - a) * i / kSteps + (c - a) * j / kSteps;
        smallest = std::min(smallest, (p - q).norm());
      }
    }
    const double found = distanceToTriangle(p, a, b, c);
    EXPECT_LE(found, smallest + 1e-12);
    EXPECT_NEAR(found, smallest, 0.01);  // half a grid cell
  }
}

// Corners of a box from (-w, -h, z0) to (w, h, z1).
std::vector<Eigen::Vector3f> boxCorners(float w, float h, float z0, float z1) {
  std::vector<Eigen::Vector3f> corners;
  for (const float x : {-w, w}) {
    for (const float y : {-h, h}) {
      for (const float z : {z0, z1}) corners.emplace_back(x, y, z);
    }
  }
  return corners;
}

TEST(Convexity, OfABoxSeenFromTheFrontIsZero) {
  const std::vector<Eigen::Vector3f> corners = boxCorners(0.1F, 0.05F, 1.0F, 1.2F);
  std::vector<Eigen::Vector3f> seen;  // the camera sees the front only
  for (int i = -5; i <= 5; ++i) {
    for (int j = -5; j <= 5; ++j) seen.emplace_back(0.02F * static_cast<float>(i), 0.01F * static_cast<float>(j), 1.0F);
  }
  ConvexHull hull;
  ASSERT_EQ(hull.build(corners), 3);
  const std::vector<float> weights(seen.size(), 1.0F);
  EXPECT_NEAR(ConvexityMeasure().compute(hull, corners, seen, weights), 0.0, kDistance_m);
}

TEST(Convexity, OfADeepStepIsTheMeanDistanceFromTheHullsFront) {
  // Front plates at both sides at z = 1, the middle set back by 5 cm: the hull closes the gap with its front face.
  const std::vector<Eigen::Vector3f> corners = boxCorners(0.2F, 0.2F, 1.0F, 1.05F);
  const std::vector<Eigen::Vector3f> points{{-0.2F, 0.0F, 1.0F}, {0.2F, 0.0F, 1.0F}, {0.0F, 0.0F, 1.05F}};
  const std::vector<float> weights{1.0F, 1.0F, 2.0F};
  ConvexHull hull;
  ASSERT_EQ(hull.build(corners), 3);
  EXPECT_NEAR(ConvexityMeasure().compute(hull, corners, points, weights), 0.025, kDistance_m);
}

TEST(Convexity, EqualsTheSmallestDistanceOverAllVisibleFaces) {
  std::mt19937 random(21);
  for (int round = 0; round < 20; ++round) {
    std::vector<Eigen::Vector3f> points = randomPoints(60, random, false);
    for (Eigen::Vector3f& p : points) p = 0.1F * p + Eigen::Vector3f(0.0F, 0.0F, 2.0F);
    ConvexHull hull;
    ASSERT_EQ(hull.build(points), 3);
    double sum = 0.0;
    for (const Eigen::Vector3f& p : points) {
      double best = 1e9;
      for (const ConvexHull::Face& face : hull.faces()) {
        const auto at = [&](std::size_t i) {
          return Eigen::Vector3d(points[static_cast<std::size_t>(face.vertices[i])].cast<double>());
        };
        const Eigen::Vector3d centre = (at(0) + at(1) + at(2)) / 3.0;
        if (face.normal.dot(-centre.normalized()) <= ConvexityMeasure::kEdgeOnCosine) continue;
        best = std::min(best, distanceToTriangle(p.cast<double>(), at(0), at(1), at(2)));
      }
      sum += best;
    }
    const std::vector<float> weights(points.size(), 1.0F);
    EXPECT_NEAR(ConvexityMeasure().compute(hull, points, points, weights), sum / static_cast<double>(points.size()),
                kDistance_m);
  }
}

TEST(Convexity, OfNothingOrWithTheCameraInsideTheHullIsZero) {
  ConvexHull hull;
  EXPECT_EQ(hull.build({}), -1);
  EXPECT_EQ(ConvexityMeasure().compute(hull, {}, {}, {}), 0.0);
  const std::vector<Eigen::Vector3f> around = boxCorners(1.0F, 1.0F, -1.0F, 1.0F);
  ASSERT_EQ(hull.build(around), 3);
  EXPECT_EQ(ConvexityMeasure().compute(hull, around, around, std::vector<float>(around.size(), 1.0F)), 0.0);
}

}  // namespace
}  // namespace saccade
