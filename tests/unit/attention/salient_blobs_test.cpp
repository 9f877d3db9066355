#include "saccade/attention/salient_blobs.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A map of few levels has plateaus; smoothed, it has blobs of all shapes.
cv::Mat1f randomMap(cv::Size size, int levels, double sigma, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat1f map(size);
  rng.fill(map, cv::RNG::UNIFORM, 0.0, 1.0);
  if (sigma > 0.0) {
    cv::GaussianBlur(map, map, cv::Size(), sigma);
    cv::normalize(map, map, 0.0, 1.0, cv::NORM_MINMAX);
  }
  for (float& v : map) {
    v = std::floor(v * static_cast<float>(levels)) / static_cast<float>(levels);
  }
  return map;
}

using PixelSet = std::set<std::pair<int, int>>;  // row, column

PixelSet pixelsOf(const SalientBlob& blob) {
  PixelSet pixels;
  for (const PixelRun& run : blob.runs) {
    for (int x = run.first_column; x < run.end_column; ++x) {
      EXPECT_TRUE(pixels.emplace(run.row, x).second) << "runs overlap";
    }
  }
  return pixels;
}

/// Pixels 8-connected to `seed` whose value is in [low, high], one by one.
PixelSet floodFill(const cv::Mat1f& map, cv::Point seed, float low, float high) {
  PixelSet pixels{{seed.y, seed.x}};
  std::vector<cv::Point> open{seed};
  while (!open.empty()) {
    const cv::Point p = open.back();
    open.pop_back();
    for (int y = p.y - 1; y <= p.y + 1; ++y) {
      for (int x = p.x - 1; x <= p.x + 1; ++x) {
        if (cv::Rect(cv::Point(), map.size()).contains({x, y}) && map(y, x) >= low && map(y, x) <= high &&
            pixels.emplace(y, x).second) {
          open.emplace_back(x, y);
        }
      }
    }
  }
  return pixels;
}

/// Number of plateaus of a positive value with lower pixels around them and none higher.
std::size_t countMaximaByFlooding(const cv::Mat1f& map) {
  std::set<PixelSet> plateaus;
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const float value = map(y, x);
      if (!(value > 0.0F)) {
        continue;
      }
      const PixelSet plateau = floodFill(map, {x, y}, value, value);
      bool higher = false, lower = false;
      for (const auto& [row, column] : plateau) {
        for (int v = std::max(0, row - 1); v <= std::min(map.rows - 1, row + 1); ++v) {
          for (int u = std::max(0, column - 1); u <= std::min(map.cols - 1, column + 1); ++u) {
            higher |= map(v, u) > value;
            lower |= map(v, u) < value;
          }
        }
      }
      if (lower && !higher) {
        plateaus.insert(plateau);
      }
    }
  }
  return plateaus.size();
}

BlobConfig everyBlob() {
  BlobConfig config;
  config.min_area = 0;
  config.min_prominence = 0.0;
  config.max_area_share = 1.0;
  return config;
}

TEST(LocalMaxima, AreFoundWithTheirSaliencyBrightestFirst) {
  cv::Mat1f map(20, 30, 0.0F);
  map(5, 7) = 0.5F;
  map(12, 20) = 0.9F;
  const auto maxima = findLocalMaxima(map);
  ASSERT_EQ(maxima.size(), 2U);
  EXPECT_EQ(maxima[0].position, cv::Point(20, 12));
  EXPECT_FLOAT_EQ(maxima[0].saliency, 0.9F);
  EXPECT_EQ(maxima[1].position, cv::Point(7, 5));
}

TEST(LocalMaxima, CountAPlateauOnceAndRefuseAShoulder) {
  cv::Mat1f map(20, 30, 0.0F);
  map(cv::Rect(4, 4, 5, 3)) = 0.5F;   // a plateau of its own
  map(cv::Rect(15, 8, 6, 6)) = 0.4F;  // a shoulder of the pixel below
  map(10, 21) = 0.6F;
  const auto maxima = findLocalMaxima(map);
  ASSERT_EQ(maxima.size(), 2U);
  EXPECT_EQ(maxima[0].position, cv::Point(21, 10));
  EXPECT_EQ(maxima[1].position, cv::Point(4, 4));
}

TEST(LocalMaxima, TouchingAcrossACornerAreOnePlateau) {
  cv::Mat1f map(9, 9, 0.0F);
  map(3, 3) = map(4, 4) = map(5, 3) = 0.5F;
  EXPECT_EQ(findLocalMaxima(map).size(), 1U);
}

TEST(LocalMaxima, LieInCornersAndAtBorders) {
  cv::Mat1f map(9, 9, 0.0F);
  map(0, 0) = map(8, 8) = map(0, 8) = map(4, 0) = 0.5F;
  EXPECT_EQ(findLocalMaxima(map).size(), 4U);
}

TEST(LocalMaxima, AgreeWithFloodingEveryPixel) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const cv::Mat1f map = randomMap({23, 19}, 3 + static_cast<int>(seed % 5) * 4, seed % 3 == 0 ? 0.0 : 1.2, seed);
    EXPECT_EQ(findLocalMaxima(map).size(), countMaximaByFlooding(map)) << "seed " << seed;
  }
}

TEST(LocalMaxima, OfNothingFlatOrNaNAreNone) {
  EXPECT_TRUE(findLocalMaxima(cv::Mat1f()).empty());
  EXPECT_TRUE(findLocalMaxima(cv::Mat1f(1, 1, 0.7F)).empty());
  EXPECT_TRUE(findLocalMaxima(cv::Mat1f(10, 10, 0.7F)).empty());
  EXPECT_TRUE(findLocalMaxima(cv::Mat1f(10, 10, 0.0F)).empty());
  EXPECT_TRUE(findLocalMaxima(cv::Mat1f(10, 10, kNaN)).empty());
}

TEST(SalientBlobs, HoldThePixelsAboveTheShareOfTheSeed) {
  cv::Mat1f map(40, 60, 0.0F);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      map(y, x) = std::max(0.0F, 1.0F - 0.05F * static_cast<float>(std::hypot(x - 30, y - 20)));
    }
  }
  const auto blobs = growSalientBlobs(map, findLocalMaxima(map));
  ASSERT_EQ(blobs.size(), 2U);
  for (const SalientBlob& blob : blobs) {
    const double radius = (1.0 - blob.threshold) / 0.05;
    EXPECT_EQ(blob.seed, cv::Point(30, 20));
    EXPECT_NEAR(blob.area, CV_PI * radius * radius, 0.1 * CV_PI * radius * radius);
    EXPECT_NEAR(blob.box.width, 2.0 * radius + 1.0, 2.0);
  }
  EXPECT_DOUBLE_EQ(blobs[0].threshold, 0.6);
  EXPECT_DOUBLE_EQ(blobs[1].threshold, 0.7);
}

TEST(SalientBlobs, DoNotClimbAHigherPeak) {
  cv::Mat1f map(5, 20, 0.1F);
  map(2, 5) = 0.5F;
  map(cv::Rect(6, 2, 4, 1)) = 0.45F;
  map(cv::Rect(10, 2, 3, 1)) = 0.9F;
  const auto maxima = findLocalMaxima(map);
  ASSERT_EQ(maxima.size(), 2U);
  BlobConfig config = everyBlob();
  config.thresholds = {0.7};
  const auto blobs = growSalientBlobs(map, maxima, config);
  ASSERT_EQ(blobs.size(), 2U);
  EXPECT_EQ(pixelsOf(blobs[1]), (PixelSet{{2, 5}, {2, 6}, {2, 7}, {2, 8}, {2, 9}}));
}

TEST(SalientBlobs, AreWhatAFloodFillGives) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    // Wider than a machine word of pixels, and not a multiple of it.
    const cv::Mat1f map = randomMap({150, 45}, 200, 1.0 + 0.3 * static_cast<double>(seed), seed);
    const auto maxima = findLocalMaxima(map);
    BlobConfig config = everyBlob();
    config.thresholds = {0.3, 0.6, 0.7, 0.95};
    std::set<PixelSet> expected;
    for (const SaliencyMaximum& maximum : maxima) {
      for (const double t : config.thresholds) {
        expected.insert(floodFill(map, maximum.position, static_cast<float>(t * static_cast<double>(maximum.saliency)),
                                  maximum.saliency));
      }
    }
    std::set<PixelSet> found;
    const auto blobs = growSalientBlobs(map, maxima, config);
    for (const SalientBlob& blob : blobs) {
      const PixelSet pixels = pixelsOf(blob);
      EXPECT_EQ(blob.area, static_cast<int>(pixels.size()));
      cv::Rect box;
      for (const auto& [row, column] : pixels) {
        box |= cv::Rect(column, row, 1, 1);
      }
      EXPECT_EQ(blob.box, box);
      found.insert(pixels);
    }
    EXPECT_EQ(found.size(), blobs.size()) << "identical blobs were kept, seed " << seed;
    EXPECT_TRUE(found == expected) << "seed " << seed;
  }
}

TEST(SalientBlobs, HaveRunsInRowOrderThatDoNotTouch) {
  const cv::Mat1f map = randomMap({130, 60}, 100, 2.0, 3);
  for (const SalientBlob& blob : growSalientBlobs(map, findLocalMaxima(map))) {
    for (std::size_t i = 1; i < blob.runs.size(); ++i) {
      const PixelRun &before = blob.runs[i - 1], &run = blob.runs[i];
      EXPECT_TRUE(before.row < run.row || (before.row == run.row && before.end_column < run.first_column));
    }
  }
}

TEST(SalientBlobs, OfEqualSeedsInOneRegionAppearOnce) {
  cv::Mat1f map(12, 30, 0.0F);
  map(cv::Rect(5, 4, 15, 3)) = 0.8F;
  map(5, 7) = map(5, 16) = 0.9F;
  const auto maxima = findLocalMaxima(map);
  ASSERT_EQ(maxima.size(), 2U);
  EXPECT_EQ(growSalientBlobs(map, maxima).size(), 1U);  // both seeds, both thresholds: the same 45 pixels
}

TEST(SalientBlobs, UnderTheLeastAreaAreLeftOut) {
  cv::Mat1f map(12, 30, 0.0F);
  map(cv::Rect(5, 4, 5, 2)) = 0.8F;
  BlobConfig config;
  config.min_area = 10;
  config.max_area_share = 1.0;
  EXPECT_EQ(growSalientBlobs(map, findLocalMaxima(map), config).size(), 1U);
  config.min_area = 11;
  EXPECT_EQ(growSalientBlobs(map, findLocalMaxima(map), config).size(), 0U);
}

TEST(SalientBlobs, OverTheLargestAreaAreLeftOut) {
  cv::Mat1f map(20, 30, 0.0F);
  map(cv::Rect(5, 4, 12, 10)) = 0.8F;  // a fifth of the image
  BlobConfig config;
  config.max_area_share = 0.21;
  EXPECT_EQ(growSalientBlobs(map, findLocalMaxima(map), config).size(), 1U);
  config.max_area_share = 0.19;
  EXPECT_EQ(growSalientBlobs(map, findLocalMaxima(map), config).size(), 0U);
}

TEST(SalientBlobs, StartAtMaximaThatStandOutOverTheirPass) {
  cv::Mat1f map(9, 40, 0.1F);
  map(4, 5) = 0.5F;
  map(cv::Rect(6, 4, 10, 1)) = 0.46F;  // the pass, bent
  map(cv::Rect(16, 2, 1, 3)) = 0.46F;
  map(2, 17) = 0.9F;
  map(6, 30) = 0.3F;
  const auto maxima = findLocalMaxima(map);
  ASSERT_EQ(maxima.size(), 3U);
  BlobConfig config = everyBlob();
  config.thresholds = {0.9};
  const auto seeds = [&](double prominence) {
    config.min_prominence = prominence;
    std::vector<cv::Point> found;
    for (const SalientBlob& blob : growSalientBlobs(map, maxima, config)) {
      found.push_back(blob.seed);
    }
    return found;
  };
  EXPECT_EQ(seeds(0.03), (std::vector<cv::Point>{{17, 2}, {5, 4}, {30, 6}}));
  EXPECT_EQ(seeds(0.05), (std::vector<cv::Point>{{17, 2}, {30, 6}}));
  EXPECT_EQ(seeds(0.25), (std::vector<cv::Point>{{17, 2}}));
}

TEST(SalientBlobs, OfAGrowerThatGrewOtherMapsBeforeAreTheSame) {
  const cv::Mat1f map = randomMap({100, 70}, 300, 2.0, 11), other = randomMap({65, 33}, 300, 2.0, 12);
  BlobGrower grower;
  grower.grow(other, findLocalMaxima(other));
  const auto maxima = findLocalMaxima(map);
  const auto again = grower.grow(map, maxima);
  const auto fresh = growSalientBlobs(map, maxima);
  ASSERT_EQ(again.size(), fresh.size());
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    EXPECT_EQ(again[i].runs, fresh[i].runs);
  }
}

TEST(SalientBlobs, EndAtNaN) {
  cv::Mat1f map(5, 9, 0.0F);
  map(cv::Rect(0, 2, 9, 1)) = 0.8F;
  map(2, 1) = 0.9F;
  map(cv::Rect(4, 0, 1, 5)) = kNaN;
  const auto blobs = growSalientBlobs(map, {{{1, 2}, 0.9F}}, everyBlob());
  ASSERT_EQ(blobs.size(), 1U);
  EXPECT_EQ(blobs[0].box, cv::Rect(0, 2, 4, 1));
}

TEST(SalientBlobs, RefuseSeedsOutsideAndImpossibleThresholds) {
  EXPECT_THROW((void)growSalientBlobs(cv::Mat1f(5, 5, 0.0F), {{{5, 0}, 1.0F}}), std::invalid_argument);
  EXPECT_THROW((void)growSalientBlobs(cv::Mat1f(), {{{0, 0}, 1.0F}}), std::invalid_argument);
  EXPECT_TRUE(growSalientBlobs(cv::Mat1f(), {}).empty());
  BlobConfig config;
  config.thresholds = {1.0};
  EXPECT_THROW(BlobGrower{config}, std::invalid_argument);
}

}  // namespace
}  // namespace saccade
