#include "saccade/attention/saliency.hpp"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "support/saliency_by_definition.hpp"

namespace saccade {
namespace {

using test::saliencyByDefinition;

// What the project asks of agreement with the reference program's maps.
constexpr double kLeastPearson = 0.99;
constexpr double kMostMeanDifference = 0.02;

const std::filesystem::path kData = SACCADE_TEST_DATA_DIR;

double meanDifference(const cv::Mat1f& a, const cv::Mat1f& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

double pearson(const cv::Mat1f& a, const cv::Mat1f& b) {
  cv::Mat1d x, y;
  a.convertTo(x, CV_64F);
  b.convertTo(y, CV_64F);
  x -= cv::mean(x)[0];
  y -= cv::mean(y)[0];
  return x.dot(y) / (cv::norm(x) * cv::norm(y));
}

SaliencyConfig coffee() {
  return {};
}

SaliencyConfig layersOneToFive() {
  SaliencyConfig config;
  config.first_layer = 1;
  config.last_layer = 5;
  config.surround_sigma = 5.0;
  return config;
}

cv::Mat3b randomBlobsImage(cv::Size size, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat3b image(size, cv::Vec3b(90, 110, 100));
  for (int i = 0; i < 40; ++i) {
    cv::circle(image, {rng.uniform(0, size.width), rng.uniform(0, size.height)}, rng.uniform(3, 40),
               cv::Scalar(rng.uniform(0, 256), rng.uniform(0, 256), rng.uniform(0, 256)), cv::FILLED);
  }
  return image;
}

class ReferenceMaps : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    color_ = kData / "kitchen" / (std::string(GetParam()) + ".color.jpg");
    if (!std::filesystem::exists(color_)) {
      GTEST_SKIP() << "missing " << color_;
    }
  }

  [[nodiscard]] cv::Mat1f reference(const std::string& setting) const {
    const auto path = kData / "saliency_reference" / (std::string(GetParam()) + "_" + setting + "_u16.png");
    cv::Mat1f map;
    cv::imread(path.string(), cv::IMREAD_UNCHANGED).convertTo(map, CV_32F, 1.0 / 65535.0);
    return map;
  }

  void expectAgreement(const SaliencyConfig& config, const std::string& setting) const {
    const cv::Mat3b image = cv::imread(color_.string());
    const cv::Mat1f expected = reference(setting);
    SaliencyModel model(config);
    const cv::Mat1f& map = model.compute(image);
    ASSERT_EQ(map.size(), expected.size());
    EXPECT_GE(pearson(map, expected), kLeastPearson);
    EXPECT_LE(meanDifference(map, expected), kMostMeanDifference);
    RecordProperty("pearson", std::to_string(pearson(map, expected)));
    RecordProperty("mean_difference", std::to_string(meanDifference(map, expected)));
  }

  std::filesystem::path color_;
};

TEST_P(ReferenceMaps, AreMetWithTheCoffeeSettings) {
  expectAgreement(coffee(), "coffee");
}

TEST_P(ReferenceMaps, AreMetWithLayersOneToFive) {
  expectAgreement(layersOneToFive(), "readme_l1L5c2s5");
}

TEST_P(ReferenceMaps, AreWhatTheDefinitionGives) {
  // The oracle must itself be right; 16-bit rounding and other compilers' float order leave this.
  constexpr double kRounding = 1e-4;
  const cv::Mat3b image = cv::imread(color_.string());
  EXPECT_LE(meanDifference(saliencyByDefinition(image, coffee()), reference("coffee")), kRounding);
  EXPECT_LE(meanDifference(saliencyByDefinition(image, layersOneToFive()), reference("readme_l1L5c2s5")), kRounding);
}

INSTANTIATE_TEST_SUITE_P(Kitchen, ReferenceMaps, testing::Values("frame-000000", "frame-000200", "frame-000400"),
                         [](const auto& info) { return std::string(info.param).substr(6); });

TEST(Saliency, AgreesWithTheDefinitionOnDrawnImages) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const cv::Mat3b image = randomBlobsImage({320, 256}, seed);
    SaliencyModel model;
    const cv::Mat1f expected = saliencyByDefinition(image, coffee());
    EXPECT_GE(pearson(model.compute(image), expected), kLeastPearson);
    EXPECT_LE(meanDifference(model.compute(image), expected), kMostMeanDifference);
  }
}

TEST(Saliency, OfAUniformImageIsZeroEverywhere) {
  SaliencyModel model;
  for (const cv::Vec3b& color : {cv::Vec3b(0, 0, 0), cv::Vec3b(17, 133, 201), cv::Vec3b(255, 255, 255)}) {
    EXPECT_EQ(cv::countNonZero(model.compute(cv::Mat3b(96, 128, color))), 0) << color;
  }
}

TEST(Saliency, OfOneDiscPeaksInTheDisc) {
  for (const cv::Vec3b& color : {cv::Vec3b(255, 255, 255), cv::Vec3b(0, 0, 255), cv::Vec3b(255, 60, 0)}) {
    cv::Mat3b image(240, 320, cv::Vec3b(40, 40, 40));
    const cv::Point center(140, 100);
    constexpr int kRadius = 12;
    cv::circle(image, center, kRadius, color, cv::FILLED);
    SaliencyModel model;
    cv::Point peak;
    cv::minMaxLoc(model.compute(image), nullptr, nullptr, nullptr, &peak);
    // Halving by dropping pixels moves the coarse layers by some pixels; see the reference's definition.
    EXPECT_LE(cv::norm(peak - center), kRadius / 2.0) << color << peak;
  }
}

TEST(Saliency, SpansZeroToOne) {
  SaliencyModel model;
  const cv::Mat1f& map = model.compute(randomBlobsImage({200, 150}, 5));
  double low = -1.0, high = -1.0;
  cv::minMaxLoc(map, &low, &high);
  EXPECT_FLOAT_EQ(static_cast<float>(low), 0.0F);
  EXPECT_FLOAT_EQ(static_cast<float>(high), 1.0F);
}

TEST(Saliency, DoesNotChangeWhenAConstantIsAddedToTheImage) {
  constexpr double kRounding = 1e-5;
  cv::Mat3b image = randomBlobsImage({160, 120}, 6);
  image = image / 2;
  const cv::Mat3b brighter(image + cv::Scalar(50, 50, 50));
  SaliencyModel model;
  const cv::Mat1f map = model.compute(image).clone();
  EXPECT_LE(cv::norm(map, model.compute(brighter), cv::NORM_INF), kRounding);
}

TEST(Saliency, IsTheSameOnEveryCallWhateverCameBefore) {
  const cv::Mat3b image = randomBlobsImage({97, 61}, 7);
  SaliencyModel fresh, used;
  used.compute(randomBlobsImage({97, 61}, 8));
  used.compute(randomBlobsImage({64, 33}, 9));
  EXPECT_EQ(cv::norm(fresh.compute(image), used.compute(image), cv::NORM_INF), 0.0);
}

TEST(Saliency, TakesImagesOfAnySize) {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(2, 1), cv::Size(1, 7), cv::Size(5, 3), cv::Size(33, 17), cv::Size(641, 479)}) {
    cv::Mat3b image(size);
    cv::randu(image, 0, 256);
    for (const SaliencyConfig& config : {coffee(), layersOneToFive()}) {
      SaliencyModel model(config);
      const cv::Mat1f& map = model.compute(image);
      EXPECT_EQ(map.size(), size);
      EXPECT_TRUE(cv::checkRange(map, true, nullptr, 0.0, 1.0 + 1e-6)) << size;
    }
  }
}

TEST(Saliency, TakesAPartOfALargerImage) {
  const cv::Mat3b image = randomBlobsImage({200, 150}, 10);
  const cv::Mat3b part = image(cv::Rect(31, 17, 101, 87));
  SaliencyModel model;
  const cv::Mat1f map = model.compute(part).clone();
  EXPECT_EQ(cv::norm(map, model.compute(part.clone()), cv::NORM_INF), 0.0);
}

TEST(Saliency, RefusesEmptyImagesAndImpossibleSettings) {
  SaliencyModel model;
  EXPECT_THROW(model.compute(cv::Mat3b()), std::invalid_argument);
  SaliencyConfig config;
  config.last_layer = 0;
  config.first_layer = 1;
  EXPECT_THROW(SaliencyModel{config}, std::invalid_argument);
  config = {};
  config.surround_sigma = config.center_sigma;
  EXPECT_THROW(SaliencyModel{config}, std::invalid_argument);
  config = {};
  config.scales_per_octave = 0;
  EXPECT_THROW(SaliencyModel{config}, std::invalid_argument);
}

}  // namespace
}  // namespace saccade
