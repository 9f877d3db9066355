#include "saccade/discovery/segment_table.hpp"

#include <map>

#include <gtest/gtest.h>

#include "saccade/discovery/segment_overlap.hpp"
#include "support/random_scene.hpp"

namespace saccade {
namespace {

// Sums over thousands of float values, in another order.
constexpr double kSumTolerance = 1e-4;

std::int32_t labelAt(const cv::Mat1i& labels, int v, int u) {
  if (v < 0 || u < 0 || v >= labels.rows || u >= labels.cols) return SegmentTable::kImageBorder;
  return labels(v, u);
}

TEST(SegmentTable, SumsEqualThoseCountedPixelByPixel) {
  const test::RandomScene scene = test::randomScene({97, 61}, 25, 3);
  const SegmentTable& table = scene.seen.color_segments;
  ASSERT_EQ(table.count(), scene.seen.color.count);
  for (std::int32_t id = 0; id < table.count(); ++id) {
    int area = 0, with_depth = 0;
    double saliency = 0.0, red = 0.0, z = 0.0;
    std::int64_t m21 = 0;
    std::vector<cv::Point> pixels;
    for (int v = 0; v < 61; ++v) {
      for (int u = 0; u < 97; ++u) {
        if (scene.seen.color.labels(v, u) != id) continue;
        ++area;
        pixels.emplace_back(u, v);
        saliency += static_cast<double>(scene.seen.saliency(v, u));
        red += scene.image(v, u)[2];
        z += static_cast<double>(scene.depth.vertices(v, u)[2]);
        with_depth += scene.depth.depth_m(v, u) > 0.0F ? 1 : 0;
        const std::int64_t x = u - table.momentOrigin().x, y = v - table.momentOrigin().y;
        m21 += x * x * y;
      }
    }
    const SegmentSums& sums = table.sums(id);
    EXPECT_EQ(sums.area, area);
    EXPECT_EQ(sums.box(), cv::boundingRect(pixels));
    EXPECT_EQ(sums.depth_count, with_depth);
    EXPECT_EQ(sums.moments.m21, m21);
    EXPECT_NEAR(sums.saliency, saliency, kSumTolerance * area);
    EXPECT_NEAR(sums.color[2], red, 1e-9);
    EXPECT_NEAR(sums.vertex[2], z, kSumTolerance * area);
  }
}

TEST(SegmentTable, EdgesCountTheCracksBetweenSegments) {
  const test::RandomScene scene = test::randomScene({53, 47}, 20, 11);
  const cv::Mat1i& labels = scene.seen.surface.labels;
  std::map<std::pair<int, int>, int> cracks, known, nearer;
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      const int own = labels(v, u);
      if (own < 0) continue;
      const cv::Point ways[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
      for (const cv::Point& way : ways) {
        const int other = labelAt(labels, v + way.y, u + way.x);
        if (other == own) continue;
        ++cracks[{own, other}];
        if (other == SegmentTable::kImageBorder) continue;
        const float a = scene.depth.depth_m(v, u), b = scene.depth.depth_m(v + way.y, u + way.x);
        if (a <= 0.0F || b <= 0.0F) continue;
        ++known[{own, other}];
        const float near = std::min(a, b);
        if (b - a > 0.010F + 0.006F * near * near) ++nearer[{own, other}];
      }
    }
  }
  std::size_t edges = 0;
  for (std::int32_t id = 0; id < scene.seen.surface_segments.count(); ++id) {
    for (const SegmentEdge& edge : scene.seen.surface_segments.edges(id)) {
      ++edges;
      EXPECT_EQ(edge.length, (cracks[{id, edge.neighbor}]));
      EXPECT_EQ(edge.known, (known[{id, edge.neighbor}]));
      EXPECT_EQ(edge.nearer, (nearer[{id, edge.neighbor}]));
    }
  }
  std::size_t expected = 0;
  for (const auto& [pair, count] : cracks) expected += count > 0 ? 1U : 0U;
  EXPECT_EQ(edges, expected);
}

TEST(SegmentTable, ManySegmentsMakeTheEdgeTableGrowWithoutLosingCracks) {
  Segmentation pixels;  // every pixel is a segment
  pixels.labels.create(80, 80);
  for (int v = 0; v < 80; ++v) {
    for (int u = 0; u < 80; ++u) pixels.labels(v, u) = v * 80 + u;
  }
  pixels.count = 6400;
  SegmentTable table;
  table.build(pixels, cv::Mat1f(80, 80, 0.0F), cv::Mat3b(80, 80, cv::Vec3b()), nullptr);
  for (std::int32_t id = 0; id < 6400; ++id) {
    int length = 0;
    for (const SegmentEdge& edge : table.edges(id)) length += edge.length;
    ASSERT_EQ(length, 4) << id;
  }
}

TEST(SegmentTable, ExtremesAreTheFarthestOfTheSampledPoints) {
  const test::RandomScene scene = test::randomScene({64, 48}, 8, 5);
  const SegmentTable& table = scene.seen.color_segments;
  for (std::int32_t id = 0; id < table.count(); ++id) {
    const SegmentTable::Extremes& extremes = table.extremes(id);
    for (const Eigen::Vector3f& sample : table.samples(id)) {
      EXPECT_GT(sample.z(), 0.0F);
      for (std::size_t d = 0; d < SegmentTable::kDirections; ++d) {
        const Eigen::Vector3f point(extremes.x[d], extremes.y[d], extremes.z[d]);
        EXPECT_TRUE(std::isfinite(extremes.reach[d]));
        EXPECT_GT(point.z(), 0.0F);
      }
    }
  }
}

TEST(SegmentTable, WrongSizesAndLabelsAreTheCallersMistake) {
  const test::RandomScene scene = test::randomScene({20, 10}, 3, 1);
  SegmentTable table;
  EXPECT_THROW(table.build(scene.seen.color, cv::Mat1f(5, 5), scene.image, nullptr), std::invalid_argument);
  EXPECT_THROW(table.build(scene.seen.color, scene.seen.saliency, cv::Mat3b(5, 5), nullptr), std::invalid_argument);
  Segmentation short_count = scene.seen.color;
  short_count.count = 1;
  EXPECT_THROW(table.build(short_count, scene.seen.saliency, scene.image, nullptr), std::invalid_argument);
}

TEST(SegmentOverlap, SharesEqualThoseCountedPixelByPixel) {
  const test::RandomScene scene = test::randomScene({71, 43}, 18, 9);
  std::map<std::pair<int, int>, int> shared;
  for (int v = 0; v < 43; ++v) {
    for (int u = 0; u < 71; ++u) {
      const int a = scene.seen.color.labels(v, u), b = scene.seen.surface.labels(v, u);
      if (a >= 0 && b >= 0) ++shared[{a, b}];
    }
  }
  std::size_t first = 0, second = 0;
  for (std::int32_t a = 0; a < scene.seen.color.count; ++a) {
    for (const auto& share : scene.seen.overlap.ofFirst(a)) {
      ++first;
      EXPECT_EQ(share.pixels, (shared[{a, share.other}]));
    }
  }
  for (std::int32_t b = 0; b < scene.seen.surface.count; ++b) {
    for (const auto& share : scene.seen.overlap.ofSecond(b)) {
      ++second;
      EXPECT_EQ(share.pixels, (shared[{share.other, b}]));
    }
  }
  EXPECT_EQ(first, shared.size());
  EXPECT_EQ(second, shared.size());
}

}  // namespace
}  // namespace saccade
