#include "saccade/segmentation/color_segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "segmentation/color_edges.hpp"

namespace saccade {
namespace {

/// Felzenszwalb & Huttenlocher 2004 as in the paper: all edges sorted by their exact weight. The oracle.
Segmentation segmentByTextbook(const cv::Mat3b& bgr, const ColorSegmentsConfig& config) {
  cv::Mat3f smooth;
  bgr.convertTo(smooth, CV_32F);
  if (config.sigma > 0.0) {
    const int size = 2 * static_cast<int>(std::ceil(4.0 * config.sigma)) + 1;
    cv::GaussianBlur(smooth, smooth, {size, size}, config.sigma, config.sigma, cv::BORDER_REPLICATE);
  }
  struct Edge {
    double weight;
    int a, b;
  };
  std::vector<Edge> edges;
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      for (const cv::Point d : {cv::Point(1, 0), cv::Point(0, 1), cv::Point(1, 1), cv::Point(-1, 1)}) {
        const cv::Point q = cv::Point(x, y) + d;
        if (cv::Rect(cv::Point(), bgr.size()).contains(q)) {
          edges.push_back({cv::norm(smooth(y, x) - smooth(q)), y * bgr.cols + x, q.y * bgr.cols + q.x});
        }
      }
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) { return l.weight < r.weight; });
  const std::size_t pixels = bgr.total();
  std::vector<int> parent(pixels), area(pixels, 1);
  std::vector<double> internal(pixels, 0.0);
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      i = parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
    }
    return static_cast<std::size_t>(i);
  };
  for (const Edge& edge : edges) {
    const std::size_t a = find(edge.a), b = find(edge.b);
    if (a != b && edge.weight <= std::min(internal[a] + config.k / area[a], internal[b] + config.k / area[b])) {
      parent[b] = static_cast<int>(a);
      area[a] += area[b];
      internal[a] = edge.weight;
    }
  }
  for (const Edge& edge : edges) {
    const std::size_t a = find(edge.a), b = find(edge.b);
    if (a != b && std::min(area[a], area[b]) < config.min_size) {
      parent[b] = static_cast<int>(a);
      area[a] += area[b];
    }
  }
  Segmentation result{cv::Mat1i(bgr.size()), 0};
  std::map<std::size_t, int> numbers;
  for (int i = 0; i < static_cast<int>(pixels); ++i) {
    result.labels(i / bgr.cols, i % bgr.cols) =
        numbers.try_emplace(find(i), static_cast<int>(numbers.size())).first->second;
  }
  result.count = static_cast<int>(numbers.size());
  return result;
}

/// The same with the segmenter's own weights, rounded to steps, and nothing left out: the oracle of its short cuts.
Segmentation segmentBySortingAllEdges(const cv::Mat3b& bgr, const ColorSegmentsConfig& config) {
  ColorEdges weights(config.sigma);
  weights.weigh(bgr);
  struct Edge {
    int step, a, b;
  };
  std::vector<Edge> edges;
  for (int y = 0; y < bgr.rows; ++y) {
    for (int d = 0; d < kEdgeDirections; ++d) {
      const cv::Point to = std::array{cv::Point(1, 0), cv::Point(0, 1), cv::Point(1, 1), cv::Point(-1, 1)}.at(
          static_cast<std::size_t>(d));
      for (int x = 0; x < bgr.cols; ++x) {
        if (cv::Rect(cv::Point(), bgr.size()).contains(cv::Point(x, y) + to)) {
          const int step = weights.steps(y, d)[x] & ColorEdges::kStepMask;
          edges.push_back({step, y * bgr.cols + x, (y + to.y) * bgr.cols + x + to.x});
        }
      }
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) { return l.step < r.step; });
  std::vector<int> label(bgr.total()), area(bgr.total(), 1);
  std::vector<float> internal(bgr.total(), 0.0F);
  std::iota(label.begin(), label.end(), 0);
  const auto find = [&](int i) {
    while (label[static_cast<std::size_t>(i)] != i) {
      i = label[static_cast<std::size_t>(i)];
    }
    return static_cast<std::size_t>(i);
  };
  const auto unite = [&](std::size_t a, std::size_t b, float weight) {
    if (area[a] < area[b]) {
      std::swap(a, b);
    }
    label[b] = static_cast<int>(a);
    area[a] += area[b];
    internal[a] = weight;
  };
  const auto k = static_cast<float>(config.k);
  for (const Edge& edge : edges) {
    const std::size_t a = find(edge.a), b = find(edge.b);
    const float weight = ColorEdges::distances()[static_cast<std::size_t>(edge.step)];
    if (a != b && accepts(internal[a], area[a], weight, k) && accepts(internal[b], area[b], weight, k)) {
      unite(a, b, weight);
    }
  }
  for (const Edge& edge : edges) {
    const std::size_t a = find(edge.a), b = find(edge.b);
    if (a != b && std::min(area[a], area[b]) < config.min_size) {
      unite(a, b, 0.0F);
    }
  }
  Segmentation result{cv::Mat1i(bgr.size()), 0};
  std::map<std::size_t, int> numbers;
  for (int i = 0; i < static_cast<int>(bgr.total()); ++i) {
    result.labels(i / bgr.cols, i % bgr.cols) =
        numbers.try_emplace(find(i), static_cast<int>(numbers.size())).first->second;
  }
  result.count = static_cast<int>(numbers.size());
  return result;
}

/// Share of the pairs of pixels on which two partitions agree (together or apart), corrected for chance: 1 = equal.
double adjustedRandIndex(const Segmentation& a, const Segmentation& b) {
  std::map<std::pair<int, int>, double> both;
  std::map<int, double> in_a, in_b;
  for (int y = 0; y < a.labels.rows; ++y) {
    for (int x = 0; x < a.labels.cols; ++x) {
      both[{a.labels(y, x), b.labels(y, x)}] += 1.0;
      in_a[a.labels(y, x)] += 1.0;
      in_b[b.labels(y, x)] += 1.0;
    }
  }
  const auto pairs = [](const auto& counts) {
    double sum = 0.0;
    for (const auto& [key, n] : counts) {
      sum += 0.5 * n * (n - 1.0);
    }
    return sum;
  };
  const double all = 0.5 * static_cast<double>(a.labels.total()) * (static_cast<double>(a.labels.total()) - 1.0);
  const double together = pairs(both), expected = pairs(in_a) * pairs(in_b) / all;
  const double most = 0.5 * (pairs(in_a) + pairs(in_b));
  return most - expected == 0.0 ? 1.0 : (together - expected) / (most - expected);
}

cv::Mat3b drawnImage(cv::Size size, double noise, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat3b image(size, cv::Vec3b(90, 110, 100));
  for (int i = 0; i < 25; ++i) {
    cv::circle(image, {rng.uniform(0, size.width), rng.uniform(0, size.height)}, rng.uniform(5, 30),
               cv::Scalar(rng.uniform(0, 256), rng.uniform(0, 256), rng.uniform(0, 256)), cv::FILLED);
  }
  cv::Mat3s noisy, deviation(size);
  image.convertTo(noisy, CV_16S);
  rng.fill(deviation, cv::RNG::NORMAL, 0.0, noise);
  cv::Mat3b out;
  cv::Mat(noisy + deviation).convertTo(out, CV_8U);
  return out;
}

TEST(ColorSegments, OfFlatRegionsAreTheRegions) {
  cv::Mat3b image(60, 90, cv::Vec3b(200, 30, 30));
  image(cv::Rect(20, 10, 30, 25)) = cv::Vec3b(30, 200, 30);
  image(cv::Rect(60, 30, 20, 20)) = cv::Vec3b(30, 30, 200);
  ColorSegmentsConfig config;
  config.sigma = 0.0;
  ColorSegmenter segmenter(config);
  const Segmentation& found = segmenter.segment(image);
  ASSERT_EQ(found.count, 3);
  EXPECT_EQ(found.labels(0, 0), 0);
  EXPECT_EQ(cv::countNonZero(found.labels == 1), 30 * 25);
  EXPECT_EQ(found.labels(15, 30), 1);
  EXPECT_EQ(cv::countNonZero(found.labels == 2), 20 * 20);
}

TEST(ColorSegments, OfACheckerboardAreItsFieldsAndJoinAcrossCornersWhereEqual) {
  constexpr int kField = 16;
  cv::Mat3b image(6 * kField, 6 * kField);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image(y, x) = (x / kField + y / kField) % 2 == 0 ? cv::Vec3b(20, 20, 20) : cv::Vec3b(230, 230, 230);
    }
  }
  ColorSegmentsConfig config;
  config.sigma = 0.0;
  ColorSegmenter segmenter(config);
  EXPECT_EQ(segmenter.segment(image).count, 2);  // 8 neighbours: equal fields touch at corners
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto shade = static_cast<std::uint8_t>(20 + 6 * (6 * (y / kField) + x / kField));
      image(y, x) = (x / kField + y / kField) % 2 == 0 ? cv::Vec3b(shade, 0, 0) : cv::Vec3b(0, shade, 255);
    }
  }
  EXPECT_EQ(segmenter.segment(image).count, 36);
}

TEST(ColorSegments, AreThoseOfTheTextbook) {
  // Weights are rounded to steps of 0.1 %, so that edges may change places with nearly equal ones.
  constexpr double kLeastAgreement = 0.98;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const cv::Mat3b image = drawnImage({160, 120}, static_cast<double>(seed), seed);
    ColorSegmentsConfig config;
    ColorSegmenter segmenter(config);
    const Segmentation& found = segmenter.segment(image);
    const Segmentation expected = segmentByTextbook(image, config);
    EXPECT_GE(adjustedRandIndex(found, expected), kLeastAgreement) << "seed " << seed;
    EXPECT_NEAR(found.count, expected.count, 0.05 * expected.count + 1.0) << "seed " << seed;
  }
}

TEST(ColorSegments, AreExactlyThoseOfTheTextbookWhereRoundingCannotMatter) {
  // Grey levels in steps of 8, unsmoothed: all weights are multiples of 8 * sqrt(3), far apart for the rounding.
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    cv::Mat1b grey(40, 50);
    cv::RNG rng(seed);
    rng.fill(grey, cv::RNG::UNIFORM, 0, 1 + static_cast<int>(seed) * 2);
    cv::resize(grey, grey, {}, 3, 3, cv::INTER_NEAREST);
    cv::Mat3b image;
    cv::cvtColor(cv::Mat(grey * 8), image, cv::COLOR_GRAY2BGR);
    ColorSegmentsConfig config;
    config.sigma = 0.0;
    config.min_size = 1;
    // Components of equal weights may still merge in another order; with a huge k all do, with none only equal ones.
    for (const double k : {0.0, 1e6}) {
      config.k = k;
      ColorSegmenter segmenter(config);
      const Segmentation expected = segmentByTextbook(image, config);
      EXPECT_EQ(cv::norm(segmenter.segment(image).labels, expected.labels, cv::NORM_INF), 0.0) << seed << " k " << k;
    }
  }
}

TEST(ColorSegments, AreExactlyThoseOfSortingAllEdges) {
  // Whole tiles, one pixel more, less than one, and several; noise makes edges that are refused early.
  for (const cv::Size size : {cv::Size(64, 32), cv::Size(65, 33), cv::Size(30, 70), cv::Size(200, 150)}) {
    for (const double noise : {0.0, 2.0, 30.0}) {
      const cv::Mat3b image = drawnImage(size, noise, 21);
      for (const double k : {0.0, 5.0, 200.0, 3000.0}) {
        for (const int min_size : {1, 50}) {
          ColorSegmentsConfig config;
          config.k = k;
          config.min_size = min_size;
          ColorSegmenter segmenter(config);
          const Segmentation& found = segmenter.segment(image);
          const Segmentation expected = segmentBySortingAllEdges(image, config);
          ASSERT_EQ(found.count, expected.count) << size << " noise " << noise << " k " << k << " min " << min_size;
          EXPECT_EQ(cv::norm(found.labels, expected.labels, cv::NORM_INF), 0.0)
              << size << " noise " << noise << " k " << k << " min " << min_size;
        }
      }
    }
  }
}

TEST(ColorSegments, OfAKitchenFrameAreThoseOfTheTextbook) {
  constexpr double kLeastAgreement = 0.9;
  const auto path = std::filesystem::path(SACCADE_TEST_DATA_DIR) / "kitchen" / "frame-000200.color.jpg";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "missing " << path;
  }
  const cv::Mat3b image = cv::imread(path.string());
  ColorSegmentsConfig config;
  ColorSegmenter segmenter(config);
  const Segmentation& found = segmenter.segment(image);
  const Segmentation expected = segmentByTextbook(image, config);
  const double agreement = adjustedRandIndex(found, expected);
  RecordProperty("adjusted_rand_index", std::to_string(agreement));
  EXPECT_GE(agreement, kLeastAgreement);
  EXPECT_NEAR(found.count, expected.count, 0.05 * expected.count);
}

TEST(ColorSegments, AreConnectedAndNumberedInRowOrderAndNotTooSmall) {
  const cv::Mat3b image = drawnImage({150, 110}, 12.0, 9);
  ColorSegmentsConfig config;
  ColorSegmenter segmenter(config);
  const Segmentation& found = segmenter.segment(image);
  int next = 0;
  for (const int label : found.labels) {
    ASSERT_GE(label, 0);
    ASSERT_LE(label, next);
    next += label == next ? 1 : 0;
  }
  EXPECT_EQ(next, found.count);
  for (int label = 0; label < found.count; ++label) {
    const cv::Mat1b mask(found.labels == label);
    cv::Mat1i parts;
    EXPECT_EQ(cv::connectedComponents(mask, parts, 8), 2) << "label " << label;
    EXPECT_GE(cv::countNonZero(mask), config.min_size);
  }
}

ColorSegmentsConfig halved() {
  ColorSegmentsConfig config;
  config.halved = true;
  return config;
}

TEST(ColorSegments, OfTheHalvedImageHaveTheOutlinesOfTheWholeOne) {
  cv::Mat3b image(61, 91, cv::Vec3b(200, 30, 30));
  image(cv::Rect(21, 11, 30, 25)) = cv::Vec3b(30, 200, 30);
  image(cv::Rect(60, 31, 21, 20)) = cv::Vec3b(30, 30, 200);
  ColorSegmentsConfig config = halved();
  config.sigma = 0.0;
  ColorSegmenter segmenter(config);
  const Segmentation& found = segmenter.segment(image);
  ASSERT_EQ(found.count, 3);
  cv::Mat1i expected(image.size(), 0);
  expected(cv::Rect(21, 11, 30, 25)) = 1;
  expected(cv::Rect(60, 31, 21, 20)) = 2;
  EXPECT_EQ(cv::norm(found.labels, expected, cv::NORM_INF), 0.0);
}

TEST(ColorSegments, OfTheHalvedImageAreMostlyThoseOfTheTextbook) {
  // Another graph of other pixels: discs come out alike (0.82 and more was seen), crumbs between them differ.
  constexpr double kLeastAgreement = 0.8;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const cv::Mat3b image = drawnImage({160, 120}, 3.0, seed);
    ColorSegmenter segmenter(halved());
    const Segmentation expected = segmentByTextbook(image, ColorSegmentsConfig());
    EXPECT_GE(adjustedRandIndex(segmenter.segment(image), expected), kLeastAgreement) << "seed " << seed;
  }
}

TEST(ColorSegments, GrowWithK) {
  const cv::Mat3b image = drawnImage({150, 110}, 6.0, 10);
  int before = static_cast<int>(image.total()) + 1;
  for (const double k : {20.0, 200.0, 2000.0, 1e6}) {
    ColorSegmentsConfig config;
    config.k = k;
    ColorSegmenter segmenter(config);
    const int count = segmenter.segment(image).count;
    EXPECT_LT(count, before) << "k " << k;
    before = count;
  }
  EXPECT_EQ(before, 1);
}

TEST(ColorSegments, AreTheSameOnEveryCallWhateverCameBefore) {
  const cv::Mat3b image = drawnImage({97, 61}, 5.0, 7);
  ColorSegmenter fresh, used;
  used.segment(drawnImage({97, 61}, 5.0, 8));
  used.segment(drawnImage({64, 33}, 5.0, 9));
  EXPECT_EQ(cv::norm(fresh.segment(image).labels, used.segment(image).labels, cv::NORM_INF), 0.0);
}

TEST(ColorSegments, TakeImagesOfAnySize) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(2, 1), cv::Size(1, 2), cv::Size(1, 70), cv::Size(70, 1),
                              cv::Size(5, 3), cv::Size(33, 17)}) {
    cv::Mat3b image(size);
    cv::RNG(3).fill(image, cv::RNG::UNIFORM, 0, 256);
    for (const ColorSegmentsConfig& config : {ColorSegmentsConfig(), halved()}) {
      ColorSegmenter segmenter(config);
      const Segmentation& found = segmenter.segment(image);
      EXPECT_EQ(found.labels.size(), size);
      EXPECT_GE(found.count, 1);
      // Noise of 0..255 on so few pixels: the smallest size joins all.
      EXPECT_LE(found.count, 1 + static_cast<int>(image.total()) / 50) << size << (config.halved ? " halved" : "");
    }
  }
}

TEST(ColorSegments, TakeAPartOfALargerImage) {
  const cv::Mat3b image = drawnImage({150, 110}, 6.0, 10);
  const cv::Mat3b part = image(cv::Rect(13, 7, 101, 87));
  ColorSegmenter segmenter;
  const cv::Mat1i labels = segmenter.segment(part).labels.clone();
  EXPECT_EQ(cv::norm(labels, segmenter.segment(part.clone()).labels, cv::NORM_INF), 0.0);
}

TEST(ColorSegments, RefuseEmptyImagesAndImpossibleSettings) {
  ColorSegmenter segmenter;
  EXPECT_THROW(segmenter.segment(cv::Mat3b()), std::invalid_argument);
  ColorSegmentsConfig config;
  config.k = -1.0;
  EXPECT_THROW(ColorSegmenter{config}, std::invalid_argument);
}

}  // namespace
}  // namespace saccade
