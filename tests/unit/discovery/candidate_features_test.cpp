#include "saccade/discovery/candidate_features.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "saccade/discovery/candidate_mask.hpp"
#include "support/random_scene.hpp"

namespace saccade {
namespace {

// cv::moments sums in doubles about the image's corner, we in whole numbers about its centre; the small Hu moments
// are differences of nearly equal sums.
constexpr double kHuRelative = 1e-6;
constexpr double kHuAbsolute = 1e-12;
constexpr double kFloatRelative = 2e-6;
// κ is taken over about 24 sampled points, of which by chance a few more or less lie in the notch of 3 cm.
constexpr double kSampled_m = 0.004;

double crackLength(const cv::Mat1b& mask) {
  double cracks = 0.0;
  const auto inside = [&](int v, int u) {
    return v >= 0 && u >= 0 && v < mask.rows && u < mask.cols && mask(v, u) != 0;
  };
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (!inside(v, u)) continue;
      cracks += !inside(v - 1, u) + !inside(v + 1, u) + !inside(v, u - 1) + !inside(v, u + 1);
    }
  }
  return cracks;
}

TEST(CandidateFeatures, EqualThoseMeasuredOnTheMask) {
  const test::RandomScene scene = test::randomScene({120, 90}, 30, 17);
  std::mt19937 random(1);
  CandidateMeasurer measurer;
  for (int round = 0; round < 40; ++round) {
    const CandidateSource source = round % 2 == 0 ? CandidateSource::kColor : CandidateSource::kDepth;
    std::vector<std::int32_t> segments;
    for (std::int32_t id = 0; id < scene.seen.table(source).count(); ++id) {
      if (random() % 6 == 0) segments.push_back(id);
    }
    if (segments.empty()) continue;
    Candidates pool{test::candidateOf(scene.seen, source, segments)};
    measurer.measure(pool, scene.seen);
    const Candidate& candidate = pool[0];

    cv::Mat1b mask;
    drawMask(candidate, scene.seen, mask);
    EXPECT_EQ(cv::countNonZero(mask), candidate.area);
    EXPECT_EQ(cv::boundingRect(mask), candidate.box);
    double hu[7];
    cv::HuMoments(cv::moments(mask, true), hu);
    SegmentSums sums;
    for (const std::int32_t segment : segments) sums += scene.seen.table(source).sums(segment);
    const std::array<double, 7> own = huMoments(sums.moments);
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_NEAR(own[i], hu[i], kHuRelative * std::abs(hu[i]) + kHuAbsolute) << "Hu moment " << i + 1;
      EXPECT_NEAR(candidate.features[i], signedLog(own[i]), 1e-5);
    }
    const double image_area = mask.size().area();
    EXPECT_NEAR(candidate.features[kFeatureArea], candidate.area / image_area, kFloatRelative);
    EXPECT_NEAR(candidate.features[kFeaturePerimeter], crackLength(mask) / image_area, kFloatRelative);
    EXPECT_NEAR(candidate.features[kFeatureSaliency], cv::mean(scene.seen.saliency, mask)[0], 1e-5);
    cv::Mat1b measured;
    cv::bitwise_and(mask, scene.depth.depth_m > 0.0F, measured);
    EXPECT_NEAR(candidate.features[kFeatureDepth], cv::mean(scene.depth.depth_m, measured)[0] / 4.0, 1e-5);
    EXPECT_TRUE(candidate.has_depth);
    EXPECT_GT(candidate.features[kFeatureConvexity], 0.0F);
    for (const float cue : candidate.cues) EXPECT_TRUE(std::isfinite(cue));
  }
}

// A front wall of depth z_left on the left half and z_right on the right half, one segment.
float convexityOfStep(double z_left, double z_right) {
  const cv::Size size(80, 60);
  std::mt19937 random(1);
  test::RandomScene scene;
  scene.image = cv::Mat3b::zeros(size);
  scene.seen.saliency = cv::Mat1f::zeros(size);
  scene.depth = test::randomDepth(size, random);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double z = u < 20 || u >= 60 ? z_left : z_right;
      const Eigen::Vector3d p = scene.depth.camera.unproject(u, v, z);
      scene.depth.depth_m(v, u) = static_cast<float>(z);
      scene.depth.vertices(v, u) = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
    }
  }
  scene.seen.color.labels = cv::Mat1i::zeros(size);
  scene.seen.color.count = 1;
  scene.seen.surface = scene.seen.color;
  scene.seen.makeTables(scene.image, &scene.depth);
  Candidates pool{test::candidateOf(scene.seen, CandidateSource::kDepth, {0})};
  CandidateMeasurer().measure(pool, scene.seen);
  return pool[0].features[kFeatureConvexity];
}

TEST(CandidateFeatures, ConvexityIsNearZeroForAWallAndGrowsWithTheDepthOfANotch) {
  EXPECT_NEAR(convexityOfStep(1.0, 1.0), 0.0, 1e-4);
  // Half of the points lie in the notch, 3 cm behind the hull's front.
  EXPECT_NEAR(convexityOfStep(1.0, 1.03), 0.015, kSampled_m);
  EXPECT_LT(convexityOfStep(1.03, 1.0), 0.75 * convexityOfStep(1.0, 1.03)) << "a bulge is more convex than a notch";
}

TEST(CandidateFeatures, WithoutDepthHaveNoConvexityAndNoDepth) {
  const test::RandomScene scene = test::randomScene({60, 40}, 8, 2, false);
  Candidates pool{test::candidateOf(scene.seen, CandidateSource::kColor, {0, 2})};
  CandidateMeasurer().measure(pool, scene.seen);
  EXPECT_FALSE(pool[0].has_depth);
  EXPECT_EQ(pool[0].features[kFeatureConvexity], 0.0F);
  EXPECT_EQ(pool[0].features[kFeatureDepth], 0.0F);
  EXPECT_GT(pool[0].features[kFeatureArea], 0.0F);
}

// A colour segment of the columns from `begin` to 40 of an image whose surfaces part at column 20.
float straddlingFrom(int begin) {
  const cv::Size size(40, 10);
  std::mt19937 random(1);
  test::RandomScene scene;
  scene.image = cv::Mat3b::zeros(size);
  scene.seen.saliency = cv::Mat1f::zeros(size);
  scene.depth = test::randomDepth(size, random);
  scene.seen.color.labels = cv::Mat1i::zeros(size);
  scene.seen.color.labels.colRange(begin, size.width) = 1;
  scene.seen.color.count = 2;
  scene.seen.surface.labels = cv::Mat1i::zeros(size);
  scene.seen.surface.labels.colRange(20, size.width) = 1;
  scene.seen.surface.count = 2;
  scene.seen.makeTables(scene.image, &scene.depth);
  Candidates pool{test::candidateOf(scene.seen, CandidateSource::kColor, {1})};
  CandidateMeasurer().measure(pool, scene.seen);
  return pool[0].cues[kCueStraddling];
}

TEST(CandidateFeatures, StraddlingIsTheShareThatCutsThroughTheOtherSegments) {
  EXPECT_FLOAT_EQ(straddlingFrom(20), 0.0F) << "exactly a surface";
  EXPECT_FLOAT_EQ(straddlingFrom(16), 4.0F / 24.0F) << "4 of 24 columns stick out of it";
  EXPECT_FLOAT_EQ(straddlingFrom(26), 6.0F / 14.0F) << "6 of the surface's columns are left out";
}

TEST(CandidateFeatures, OfASinglePixelAreFinite) {
  Perception seen;
  seen.saliency = cv::Mat1f::ones(5, 5);
  seen.color.labels = cv::Mat1i(5, 5, -1);
  seen.color.labels(2, 3) = 0;
  seen.color.count = 1;
  seen.makeTables(cv::Mat3b(5, 5, cv::Vec3b()), nullptr);
  Candidates pool{test::candidateOf(seen, CandidateSource::kColor, {0})};
  CandidateMeasurer().measure(pool, seen);
  EXPECT_EQ(pool[0].area, 1);
  for (const float feature : pool[0].features) EXPECT_TRUE(std::isfinite(feature));
  EXPECT_FLOAT_EQ(pool[0].features[kFeaturePerimeter], 4.0F / 25.0F);
}

TEST(SignedLog, IsOddContinuousAtZeroAndALogarithmFarFromIt) {
  EXPECT_EQ(signedLog(0.0), 0.0);
  EXPECT_NEAR(signedLog(1e-3), 7.0, 1e-6);
  EXPECT_DOUBLE_EQ(signedLog(-0.2), -signedLog(0.2));
  EXPECT_NEAR(signedLog(1e-14), 0.0, 1e-3);
}

}  // namespace
}  // namespace saccade
