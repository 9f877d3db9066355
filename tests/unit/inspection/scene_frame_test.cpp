#include "saccade/inspection/scene_frame.hpp"

#include <gtest/gtest.h>

#include "saccade/inspection/up_direction.hpp"
#include "support/ior_trees.hpp"

namespace saccade {
namespace {

using test::setLeaf;

constexpr int kCentre = MapTree::kCentreKey;
constexpr double kLeafSize_m = 0.05;
constexpr double kNormalStep = 0.01;  // normals are kept in steps of 1 / 127

void setFacing(IorOcTree& tree, int x, int y, int z, const Eigen::Vector3f& normal) {
  setLeaf(tree, kCentre + x, kCentre + y, kCentre + z, true);
  LeafSurface surface;
  surface.setNormal(normal);
  tree.findFinestLeaf(test::octoKey(kCentre + x, kCentre + y, kCentre + z))->setSurface(surface);
}

/// A floor that faces `up` and a larger wall that faces -z.
void buildRoom(IorOcTree& tree, const Eigen::Vector3f& up) {
  for (int x = 0; x < 30; ++x) {
    for (int z = 0; z < 30; ++z) setFacing(tree, x, 0, z, up);
    for (int y = -40; y < 0; ++y) setFacing(tree, x, y, 30, {0.0f, 0.0f, -1.0f});
  }
  tree.updateInnerNodes();
}

/// Frames of a camera that looks along z of W, tilted by `tilt_rad` around x.
std::vector<FrameRecord> framesTilted(double tilt_rad) {
  FrameRecord frame;
  frame.T_WC = Pose(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()));
  return std::vector<FrameRecord>(3, frame);
}

TEST(SceneFrame, UpIsTheFloorsNormalThoughTheCameraTiltsAndMoreAreaIsWall) {
  for (const double tilt_rad : {-0.5, 0.0, 0.5}) {
    const Eigen::Vector3f up = Eigen::Vector3f(0.1f, -1.0f, -0.2f).normalized();
    IorOcTree tree(kLeafSize_m);
    buildRoom(tree, up);
    const Eigen::Vector3d found = estimateUp(tree.view(), framesTilted(tilt_rad));
    EXPECT_NEAR((found - up.cast<double>()).norm(), 0.0, kNormalStep) << tilt_rad;
  }
}

TEST(SceneFrame, WithoutPosesUpIsNearZAsInMapsOfOctoMap) {
  IorOcTree tree(kLeafSize_m);
  const Eigen::Vector3f up = Eigen::Vector3f(0.2f, 0.0f, 1.0f).normalized();
  buildRoom(tree, up);
  EXPECT_NEAR((estimateUp(tree.view(), {}) - up.cast<double>()).norm(), 0.0, kNormalStep);
}

TEST(SceneFrame, WithoutNormalsUpIsTheMeanOfTheCameras) {
  const IorOcTree tree(kLeafSize_m);
  EXPECT_EQ(estimateUp(tree.view(), {}), Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d expected(0.0, -std::cos(0.3), -std::sin(0.3));
  EXPECT_NEAR((estimateUp(tree.view(), framesTilted(0.3)) - expected).norm(), 0.0, 1e-9);
}

TEST(SceneFrame, TheBoxLeavesOutAStrayLeaf) {
  IorOcTree tree(kLeafSize_m);
  buildRoom(tree, {0.0f, -1.0f, 0.0f});
  setFacing(tree, 900, 0, 0, {0.0f, -1.0f, 0.0f});
  tree.updateInnerNodes();
  const SceneFrame scene = findSceneFrame(tree.view(), framesTilted(0.0));
  EXPECT_NEAR(scene.box.max().x(), 30 * kLeafSize_m, 1e-9);
  EXPECT_NEAR(scene.box.min().y(), -40 * kLeafSize_m, 1e-9);
}

TEST(SceneFrame, AnEmptyMapHasNoBox) {
  const IorOcTree tree(kLeafSize_m);
  EXPECT_TRUE(findSceneFrame(tree.view(), {}).empty());
}

}  // namespace
}  // namespace saccade
