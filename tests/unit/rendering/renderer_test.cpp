#include "saccade/rendering/renderer.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/ior_trees.hpp"

namespace saccade {
namespace {

using test::lookAlong;
using test::setLeaf;

constexpr int kCentre = MapTree::kCentreKey;
constexpr double kLeafSize_m = 0.05;
// Depths are float computations over ranges of a few metres.
constexpr double kDepthTolerance_m = 1e-5;

const PinholeCamera kCamera{64, 48, 60.0, 60.0, 31.5, 23.5};
const Eigen::Vector3d kAlongX = Eigen::Vector3d::UnitX(), kUp = Eigen::Vector3d::UnitZ();

/// Leaves from -1 m to 1 m in y and z whose near face is at x = 1.5 m.
void buildWall(IorOcTree& tree) {
  for (int y = -20; y < 20; ++y) {
    for (int z = -20; z < 20; ++z) setLeaf(tree, kCentre + 30, kCentre + y, kCentre + z, true);
  }
  tree.updateInnerNodes();
}

int holes(const IorView& view) {
  return view.leaf_index.rows * view.leaf_index.cols - cv::countNonZero(view.leaf_index != IorView::kNoLeaf);
}

void expectAllHoles(const IorView& view) {
  EXPECT_EQ(view.leaf_index.size(), cv::Size(view.camera.width, view.camera.height));
  EXPECT_EQ(holes(view), view.camera.width * view.camera.height);
  EXPECT_EQ(cv::countNonZero(view.depth_m), 0);
  EXPECT_EQ(cv::countNonZero(view.inhibited), 0);
  EXPECT_TRUE(view.leaves.empty());
}

TEST(Renderer, SeesAWallAtItsNearFaceInEveryPixel) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  Renderer renderer;
  const Pose T_WC = lookAlong({0.01, 0.02, 0.03}, kAlongX, kUp);
  const IorView& view = renderer.renderIor(tree.view(), kCamera, T_WC);
  EXPECT_EQ(holes(view), 0);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      ASSERT_NEAR(view.depth_m(v, u), 1.49, kDepthTolerance_m);
      const Eigen::Vector3d p_W = T_WC * kCamera.unproject(u, v, 1.49);
      const LeafKey expected{kCentre + 30, static_cast<std::uint16_t>(kCentre + std::floor(p_W.y() / kLeafSize_m)),
                             static_cast<std::uint16_t>(kCentre + std::floor(p_W.z() / kLeafSize_m))};
      ASSERT_EQ(view.keyAt(u, v), expected) << u << " " << v;
    }
  }
}

TEST(Renderer, SeesABallOfLeavesWithinOneLeafOfItsSurface) {
  constexpr double kRadius_m = 0.6;
  const Eigen::Vector3d centre(2.0, 0.0, 0.0);
  IorOcTree tree(kLeafSize_m);
  for (int x = -15; x < 15; ++x) {
    for (int y = -15; y < 15; ++y) {
      for (int z = -15; z < 15; ++z) {
        const Eigen::Vector3d middle = kLeafSize_m * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
        if (middle.norm() < kRadius_m) setLeaf(tree, kCentre + 40 + x, kCentre + y, kCentre + z, true);
      }
    }
  }
  tree.updateInnerNodes();
  Renderer renderer;
  const Pose T_WC = lookAlong({0.0, 0.0, 0.0}, kAlongX, kUp);
  const SurfaceView& view = renderer.renderSurface(tree.view(), kCamera, T_WC);
  int seen = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector3d direction = T_WC.linear() * kCamera.unproject(u, v, 1.0);
      const double offset_m = centre.cross(direction.normalized()).norm();
      if (offset_m > kRadius_m + kLeafSize_m) {
        ASSERT_EQ(view.ior.depth_m(v, u), 0.0f);
      }
      if (offset_m > kRadius_m - kLeafSize_m) continue;
      ++seen;
      const Eigen::Vector3d p_W = view.ior.depth_m(v, u) * direction;
      ASSERT_NEAR((p_W - centre).norm(), kRadius_m, kLeafSize_m * std::sqrt(3.0) / 2.0) << u << " " << v;
      const cv::Vec3f normal = view.normals(v, u);
      ASSERT_NEAR(cv::norm(normal), 1.0, 1e-6);
      ASSERT_LT(normal.dot(cv::Vec3f(static_cast<float>(direction.x()), static_cast<float>(direction.y()),
                                     static_cast<float>(direction.z()))),
                0.0);
    }
  }
  EXPECT_GT(seen, 500);
}

TEST(Renderer, PassesFreeAndUnknownSpaceAlike) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  for (int x = 4; x < 20; ++x) setLeaf(tree, kCentre + x, kCentre, kCentre, false);
  Renderer renderer;
  const IorView& view = renderer.renderIor(tree.view(), kCamera, lookAlong({0, 0, 0}, kAlongX, kUp));
  EXPECT_EQ(holes(view), 0);
  EXPECT_NEAR(view.depth_m(24, 32), 1.5, kDepthTolerance_m);
}

TEST(Renderer, ShowsWeightAndFlagOfTheLawAtTheMapsTick) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  const IorState attended(12, true), unflagged(30, false);
  tree.findFinestLeaf(test::octoKey(kCentre + 30, kCentre, kCentre))->setIor(attended);
  tree.findFinestLeaf(test::octoKey(kCentre + 30, kCentre + 1, kCentre))->setIor(unflagged);
  tree.updateInnerNodes();
  Renderer renderer;
  for (const std::uint32_t now : {0u, 5u, 11u, 12u, 29u, 30u, 1000u}) {
    tree.setNow({now});
    const SurfaceView& view = renderer.renderSurface(tree.view(), kCamera, lookAlong({0.01, 0.02, 0.03}, kAlongX, kUp));
    EXPECT_EQ(view.ior.now, Tick{now});
    int with_memory = 0;
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        const LeafKey key = view.ior.keyAt(u, v).value();
        const IorState state = key == LeafKey{kCentre + 30, kCentre, kCentre}       ? attended
                               : key == LeafKey{kCentre + 30, kCentre + 1, kCentre} ? unflagged
                                                                                    : IorState();
        with_memory += state == IorState() ? 0 : 1;
        ASSERT_EQ(view.ior.inhibited(v, u), inhibited(state, {now}) ? 255 : 0);
        ASSERT_EQ(view.ior.familiar(v, u), isFamiliar(state, {now}) ? 255 : 0);
        ASSERT_EQ(view.ior.weightAt(u, v), weight(state, {now}));
        ASSERT_EQ(view.weight(v, u), static_cast<int>(weight(state, {now})));
      }
    }
    EXPECT_GT(with_memory, 4);
  }
}

TEST(Renderer, ShowsColourAndNormalThatALeafRemembers) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  LeafSurface surface;
  surface.blue = 10;
  surface.green = 20;
  surface.red = 30;
  surface.setNormal(Eigen::Vector3f(-0.6f, 0.8f, 0.0f));
  tree.findFinestLeaf(test::octoKey(kCentre + 30, kCentre, kCentre))->setSurface(surface);
  Renderer renderer;
  const SurfaceView& view = renderer.renderSurface(tree.view(), kCamera, lookAlong({0.0, 0.025, 0.025}, kAlongX, kUp));
  const int u = 31, v = 23;
  EXPECT_EQ(view.color(v, u), cv::Vec3b(10, 20, 30));
  EXPECT_NEAR(view.normals(v, u)[1], 0.8f, 0.01);      // quantised to 1/127
  EXPECT_EQ(view.normals(0, 0), cv::Vec3f(-1, 0, 0));  // a leaf without: the face that was entered
  EXPECT_EQ(view.color(0, 0), cv::Vec3b(0, 0, 0));
}

TEST(Renderer, GivesTheFinestKeyOfTheCellEnteredInACoarseLeaf) {
  IorOcTree tree(kLeafSize_m);
  for (int i = 0; i < 512; ++i) setLeaf(tree, kCentre + 32 + (i & 7), kCentre + (i >> 3 & 7), kCentre + (i >> 6), true);
  tree.updateInnerNodes();
  ASSERT_EQ(tree.getNumLeafNodes(), 1u);  // one leaf of 8³ cells
  Renderer renderer;
  const Pose T_WC = lookAlong({0.01, 0.2, 0.2}, kAlongX, kUp);
  const IorView& view = renderer.renderIor(tree.view(), kCamera, T_WC);
  EXPECT_EQ(view.leaves.size(), 64u);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector3d p_W = T_WC * kCamera.unproject(u, v, 1.59);
      const auto y = static_cast<int>(std::floor(p_W.y() / kLeafSize_m));
      const auto z = static_cast<int>(std::floor(p_W.z() / kLeafSize_m));
      const bool on_cube = y >= 0 && y < 8 && z >= 0 && z < 8;
      ASSERT_EQ(view.keyAt(u, v).has_value(), on_cube);
      if (!on_cube) continue;
      ASSERT_EQ(*view.keyAt(u, v), (LeafKey{kCentre + 32, static_cast<std::uint16_t>(kCentre + y),
                                            static_cast<std::uint16_t>(kCentre + z)}));
    }
  }
}

TEST(Renderer, SeesFromInsideAnOccupiedLeaf) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  setLeaf(tree, kCentre, kCentre, kCentre, true);
  const Pose T_WC = lookAlong({0.025, 0.025, 0.025}, kAlongX, kUp);
  Renderer renderer;
  const IorView& view = renderer.renderIor(tree.view(), kCamera, T_WC);
  EXPECT_EQ(holes(view), 0);
  EXPECT_NEAR(view.depth_m(24, 32), 1.475, kDepthTolerance_m);

  // Where the ray starts inside a leaf that leaf is seen, at the near depth and facing the camera.
  Renderer close({.near_m = 0.01});
  const SurfaceView& own = close.renderSurface(tree.view(), kCamera, T_WC);
  EXPECT_EQ(own.ior.keyAt(32, 24), (LeafKey{kCentre, kCentre, kCentre}));
  EXPECT_NEAR(own.ior.depth_m(24, 32), 0.01, kDepthTolerance_m);
  EXPECT_NEAR(own.normals(24, 32)[0], -1.0f, 0.01);
}

TEST(Renderer, SeesLeavesThatCrossTheCamerasOwnPlane) {
  constexpr double kBigLeaf_m = 1.0;
  IorOcTree tree(kBigLeaf_m);
  for (int y = -8; y < 8; ++y) {  // a floor of 1 m blocks that the camera stands on, top at z = 0
    for (int x = -8; x < 8; ++x) setLeaf(tree, kCentre + x, kCentre + y, kCentre - 1, true);
  }
  tree.updateInnerNodes();
  Renderer renderer;
  const IorView& view = renderer.renderIor(tree.view(), kCamera, lookAlong({0.3, 0.4, 0.2}, kAlongX, kUp));
  for (int v = 24; v < kCamera.height; ++v) {
    const double expected_m = 0.2 / ((v - kCamera.cy) / kCamera.fy);
    ASSERT_NEAR(view.depth_m(v, 32), expected_m > 7.69 ? 0.0 : expected_m, 1e-4) << v;
  }
  EXPECT_EQ(cv::countNonZero(view.depth_m.rowRange(0, 24)), 0);
}

TEST(Renderer, SeesNothingNearerThanNearOrBeyondFar) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  const Pose T_WC = lookAlong({0.0, 0.0, 0.0}, kAlongX, kUp);
  Renderer short_sighted({.far_m = 1.49});
  expectAllHoles(short_sighted.renderIor(tree.view(), kCamera, T_WC));
  Renderer long_sighted({.near_m = 1.56});
  expectAllHoles(long_sighted.renderIor(tree.view(), kCamera, T_WC));
  Renderer within({.near_m = 1.52, .far_m = 1.53});
  EXPECT_NEAR(within.renderIor(tree.view(), kCamera, T_WC).depth_m(24, 32), 1.52, kDepthTolerance_m);
}

TEST(Renderer, GivesHolesForAnEmptyTreeAFreeTreeAndACameraOutsideTheMap) {
  Renderer renderer;
  IorOcTree tree(kLeafSize_m);
  const Pose T_WC = lookAlong({0.0, 0.0, 0.0}, kAlongX, kUp);
  expectAllHoles(renderer.renderIor(tree.view(), kCamera, T_WC));
  setLeaf(tree, kCentre + 20, kCentre, kCentre, false);
  tree.updateInnerNodes();
  expectAllHoles(renderer.renderIor(tree.view(), kCamera, T_WC));
  buildWall(tree);
  EXPECT_EQ(holes(renderer.renderIor(tree.view(), kCamera, T_WC)), 0);
  expectAllHoles(renderer.renderIor(tree.view(), kCamera, lookAlong({0, 0, 0}, -kAlongX, kUp)));
  expectAllHoles(renderer.renderIor(tree.view(), kCamera, lookAlong({1e5, 2, 3}, kAlongX, kUp)));
  expectAllHoles(renderer.renderIor(tree.view(), kCamera, lookAlong({-1e12, 2, 3}, kAlongX, kUp)));
}

TEST(Renderer, SeesTheLastLeavesOfTheKeySpaceAlsoFromOutside) {
  IorOcTree tree(kLeafSize_m);
  const double edge_m = (65536 - kCentre) * kLeafSize_m;
  for (const auto& [key, sign] : {std::pair{65535, 1.0}, std::pair{0, -1.0}}) {
    setLeaf(tree, key, key, key, true);
    tree.updateInnerNodes();
    const Eigen::Vector3d middle = Eigen::Vector3d::Constant(sign * (edge_m - 0.5 * kLeafSize_m));
    Renderer renderer;
    for (const double from : {-1.0, 1.0}) {
      const Pose T_WC = lookAlong(middle + Eigen::Vector3d(from, 0.0, 0.0), {-from, 0.0, 0.0}, kUp);
      const PinholeCamera centred{33, 33, 400.0, 400.0, 16.0, 16.0};
      const IorView& view = renderer.renderIor(tree.view(), centred, T_WC);
      const auto k = static_cast<std::uint16_t>(key);
      EXPECT_EQ(view.keyAt(16, 16), (LeafKey{k, k, k})) << key << " " << from;
      EXPECT_NEAR(view.depth_m(16, 16), 1.0 - 0.5 * kLeafSize_m, 1e-4);
    }
  }
}

TEST(Renderer, RendersImagesOfAnySize) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  Renderer renderer;
  const Pose T_WC = lookAlong({0.01, 0.02, 0.03}, kAlongX, kUp);
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {8, 8}, {9, 17}, {63, 1}, {1, 63}, {65, 47}}) {
    const PinholeCamera camera{width, height, 60.0, 60.0, (width - 1) / 2.0, (height - 1) / 2.0};
    const IorView& view = renderer.renderIor(tree.view(), camera, T_WC);
    EXPECT_EQ(view.depth_m.size(), cv::Size(width, height));
    EXPECT_TRUE(view.depth_m.isContinuous());
    EXPECT_EQ(holes(view), 0) << width << "x" << height;
    EXPECT_NEAR(view.depth_m(height - 1, width - 1), 1.49, kDepthTolerance_m);
  }
}

TEST(Renderer, ClonesAViewThatOutlivesTheNextOne) {
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  Renderer renderer;
  const Pose T_WC = lookAlong({0.0, 0.0, 0.0}, kAlongX, kUp);
  const IorView kept = cloneView(renderer.renderIor(tree.view(), kCamera, T_WC));
  expectAllHoles(renderer.renderIor(tree.view(), kCamera, lookAlong({0, 0, 0}, -kAlongX, kUp)));
  EXPECT_EQ(holes(kept), 0);
}

TEST(Renderer, RefusesBadRangesCamerasAndPoses) {
  EXPECT_THROW(Renderer({.near_m = 2.0, .far_m = 2.0}), std::invalid_argument);
  EXPECT_THROW(Renderer({.near_m = 0.0}), std::invalid_argument);
  IorOcTree tree(kLeafSize_m);
  buildWall(tree);
  Renderer renderer;
  const Pose T_WC = lookAlong({0, 0, 0}, kAlongX, kUp);
  PinholeCamera camera = kCamera;
  camera.width = 0;
  EXPECT_THROW(std::ignore = renderer.renderIor(tree.view(), camera, T_WC), std::invalid_argument);
  camera = kCamera;
  camera.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(std::ignore = renderer.renderIor(tree.view(), camera, T_WC), std::invalid_argument);
  Pose broken = T_WC;
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(std::ignore = renderer.renderIor(tree.view(), kCamera, broken), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
