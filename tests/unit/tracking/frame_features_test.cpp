#include "saccade/tracking/frame_features.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <rapidcheck/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

// Random rectangles: corners everywhere. Depth only on the left three quarters.
struct Picture {
  PinholeCamera camera{320, 240, 292.5, 292.5, 159.5, 119.5};
  cv::Mat3b color = cv::Mat3b(240, 320, cv::Vec3b(90, 90, 90));
  DepthMaps depth;

  Picture() {
    cv::RNG random(7);
    for (int i = 0; i < 120; ++i) {
      const cv::Rect box(random.uniform(0, 300), random.uniform(0, 220), random.uniform(6, 40), random.uniform(6, 40));
      cv::rectangle(color, box, cv::Scalar::all(random.uniform(0, 256)), cv::FILLED);
    }
    cv::Mat1f depth_m(240, 320, 0.0F);
    depth_m(cv::Rect(0, 0, 240, 240)) = 1.5F;
    DepthPreparation().prepare(depth_m, camera, depth);
  }
};

FrameFeatures somewhere(int count) {
  FrameFeatures features;
  features.descriptors.create(count, FrameFeatures::kDescriptorBytes);
  cv::RNG random(3);
  if (count > 0) random.fill(features.descriptors, cv::RNG::UNIFORM, 0, 256);
  for (int i = 0; i < count; ++i) {
    features.pixels.emplace_back(random.uniform(0.0F, 640.0F), random.uniform(0.0F, 480.0F));
    features.points_C.emplace_back(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F),
                                   random.uniform(0.3F, 4.0F));
  }
  return features;
}

TEST(FeatureExtractor, FindsFeaturesOnlyWhereDepthWasMeasuredAndPlacesThemThere) {
  const Picture picture;
  const FrameFeatures found = FeatureExtractor().extract(picture.color, picture.depth);
  ASSERT_GT(found.size(), 100U);
  ASSERT_EQ(found.descriptors.rows, static_cast<int>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT(found.pixels[i].x(), 240.0F);
    const Eigen::Vector2d back = picture.camera.project(found.points_C[i].cast<double>());
    // The point is that of the nearest pixel; the feature lies between pixels.
    EXPECT_LT((back - found.pixels[i].cast<double>()).lpNorm<Eigen::Infinity>(), 0.51);
  }
}

TEST(FeatureExtractor, FindsTheSameFeaturesTwice) {
  const Picture picture;
  EXPECT_TRUE(FeatureExtractor().extract(picture.color, picture.depth) ==
              FeatureExtractor().extract(picture.color, picture.depth));
}

TEST(FeatureExtractor, FindsNothingInABlankImage) {
  Picture picture;
  picture.color = cv::Vec3b(90, 90, 90);
  EXPECT_EQ(FeatureExtractor().extract(picture.color, picture.depth).size(), 0U);
}

TEST(FeatureExtractor, RefusesImagesOfDifferentSizes) {
  Picture picture;
  picture.color = cv::Mat3b(120, 160);
  EXPECT_THROW((void)FeatureExtractor().extract(picture.color, picture.depth), std::invalid_argument);
}

TEST(FeatureBytes, GiveTheSameFeaturesBack) {
  for (const int count : {0, 1, 500}) {
    const FrameFeatures features = somewhere(count);
    const auto back = decodeFeatures(encodeFeatures(features));
    ASSERT_TRUE(back);
    EXPECT_TRUE(*back == features);
  }
}

TEST(FeatureBytes, AreRefusedWhenTruncatedAnywhere) {
  const std::string bytes = encodeFeatures(somewhere(20));
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(decodeFeatures({bytes.data(), size})) << size;
  EXPECT_FALSE(decodeFeatures(bytes + "x"));
}

TEST(FeatureBytes, AreRefusedWhenTheyHoldAnImpossiblePlace) {
  FrameFeatures behind = somewhere(3), endless = somewhere(3);
  behind.points_C[1].z() = -1.0F;
  endless.pixels[2].x() = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(decodeFeatures(encodeFeatures(behind)));
  EXPECT_FALSE(decodeFeatures(encodeFeatures(endless)));
}

RC_GTEST_PROP(FeatureBytes, OfAnyOriginAreEitherRefusedOrExact, ()) {
  std::string bytes = encodeFeatures(somewhere(4));
  const auto at = *rc::gen::inRange<std::size_t>(0, bytes.size());
  bytes[at] = *rc::gen::arbitrary<char>();
  const auto features = decodeFeatures(bytes);
  if (features) RC_ASSERT(encodeFeatures(*features) == bytes);
}

}  // namespace
}  // namespace saccade
