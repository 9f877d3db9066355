#include "saccade/inspection/layer_picture.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/rendering/renderer.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

using test::lookAlong;
using test::setLeaf;

constexpr int kCentre = MapTree::kCentreKey;
constexpr double kLeafSize_m = 0.05;
const PinholeCamera kCamera{64, 48, 60.0, 60.0, 31.5, 23.5};
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();
const cv::Vec3b kBackground(1, 2, 3);

/// A wall 1.5 m ahead along x, ±0.5 m in y and z, its leaves with y >= 0 red and inhibited until tick 50.
class LayerPicture : public ::testing::Test {
 protected:
  LayerPicture() : tree_(kLeafSize_m) {
    for (int y = -10; y < 10; ++y) {
      for (int z = -10; z < 10; ++z) {
        setLeaf(tree_, kCentre + 30, kCentre + y, kCentre + z, true);
        if (y < 0) continue;
        IorOcTreeNode* leaf = tree_.findFinestLeaf(test::octoKey(kCentre + 30, kCentre + y, kCentre + z));
        leaf->setIor(IorState(50, true));
        LeafSurface surface;
        surface.red = 200;
        leaf->setSurface(surface);
      }
    }
    tree_.setNow(Tick{10});
    tree_.updateInnerNodes();
  }

  cv::Mat3b paint(PictureLayer layer) {
    const SurfaceView& view =
        renderer_.renderSurface(tree_.view(), kCamera, lookAlong({0.01, 0.02, 0.03}, {1, 0, 0}, kUp));
    return paintLayer(view, layer, tree_.view(), kUp, rangeOf(view, layer, tree_.view(), kUp), kBackground);
  }

  IorOcTree tree_;
  Renderer renderer_;
};

// Looking along x with z up, y >= 0 is the picture's left half.
constexpr int kLeft = 25, kRight = 39, kMiddle = 24;

TEST_F(LayerPicture, HolesAreTheBackgroundInEveryLayer) {
  for (const std::string& name : pictureLayerNames()) {
    EXPECT_EQ(paint(pictureLayer(name))(0, 0), kBackground) << name;
    EXPECT_NE(paint(pictureLayer(name))(kMiddle, kLeft), kBackground) << name;
  }
}

TEST_F(LayerPicture, ColourIsWhatTheLeavesRemember) {
  EXPECT_EQ(paint(PictureLayer::kColor)(kMiddle, kLeft), cv::Vec3b(0, 0, 200));
  EXPECT_EQ(paint(PictureLayer::kColor)(kMiddle, kRight), cv::Vec3b(0, 0, 0));
}

TEST_F(LayerPicture, TheFlagIsWhiteExactlyWhereLeavesInhibit) {
  EXPECT_EQ(paint(PictureLayer::kIorFlag)(kMiddle, kLeft), cv::Vec3b(255, 255, 255));
  EXPECT_NE(paint(PictureLayer::kIorFlag)(kMiddle, kRight), cv::Vec3b(255, 255, 255));
}

TEST_F(LayerPicture, TheWeightIsPaintedOnlyWhereThereIsSome) {
  const SurfaceView& view =
      renderer_.renderSurface(tree_.view(), kCamera, lookAlong({0.01, 0.02, 0.03}, {1, 0, 0}, kUp));
  EXPECT_DOUBLE_EQ(rangeOf(view, PictureLayer::kIorWeight, tree_.view(), kUp).highest, 40.0);
  const cv::Vec3b forgotten = paint(PictureLayer::kIorWeight)(kMiddle, kRight);
  EXPECT_EQ(forgotten, cv::Vec3b(0, 0, 0)) << "a black leaf without weight stays black";
  EXPECT_NE(paint(PictureLayer::kIorWeight)(kMiddle, kLeft), forgotten);
}

TEST_F(LayerPicture, HeightRisesFromDarkToYellowAlongUp) {
  const cv::Mat3b picture = paint(PictureLayer::kHeight);
  const auto yellow = [](const cv::Vec3b& bgr) { return bgr[1] + bgr[2] - bgr[0]; };
  EXPECT_GT(yellow(picture(kMiddle - 15, kRight)), yellow(picture(kMiddle + 15, kRight)) + 100);
}

TEST(LayerPictureNames, AnUnknownLayerIsRefusedWithTheKnownOnes) {
  try {
    (void)pictureLayer("heat");
    FAIL() << "no layer is called heat";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("flag"), std::string::npos);
  }
}

}  // namespace
}  // namespace saccade
