#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "rendering/octree_walk.hpp"
#include "saccade/rendering/renderer.hpp"
#include "support/ior_trees.hpp"
#include "support/ray_descent.hpp"

namespace saccade {
namespace {

using test::RayDescent;

constexpr double kNear_m = 0.01, kFar_m = 6.0;
// A ray that runs through a leaf for less than this may be given to the leaf behind it or before it: the renderer works
// in float, and rays that graze an edge pass it by less than its rounding.
constexpr double kGrazing_m = 2e-4;
constexpr double kDepthTolerance_m = 2e-5;

struct Agreement {
  int rays = 0, same = 0, grazing = 0;
};

/// Whether two answers for a ray differ only by a leaf that the ray merely grazes.
bool isGrazing(const RayDescent& oracle, const std::optional<LeafKey>& a, const std::optional<LeafKey>& b, int u,
               int v) {
  return (a && oracle.inside(*a, u, v).length() < kGrazing_m) || (b && oracle.inside(*b, u, v).length() < kGrazing_m);
}

/// Compares every `step`th pixel with the oracle, key, depth and memory.
Agreement compareWithDescent(const IorView& view, const MapTree& map, int step) {
  const RayDescent oracle(map, view.camera, view.T_WC, kNear_m, kFar_m);
  Agreement agreement;
  for (int v = 0; v < view.camera.height; v += step) {
    for (int u = v % step; u < view.camera.width; u += step) {
      ++agreement.rays;
      const auto expected = oracle.cast(u, v);
      const auto found = view.keyAt(u, v);
      const auto expected_key = expected ? std::optional(expected->key) : std::nullopt;
      if (found == expected_key) {
        ++agreement.same;
        if (!expected) continue;
        EXPECT_NEAR(view.depth_m(v, u), expected->depth_m, kDepthTolerance_m);
        EXPECT_EQ(view.leafAt(u, v)->ior, expected->ior);
        EXPECT_EQ(view.inhibited(v, u) != 0, inhibited(expected->ior, map.now));
      } else if (isGrazing(oracle, found, expected_key, u, v)) {
        ++agreement.grazing;
      } else {
        ADD_FAILURE() << "pixel " << u << " " << v << ": depth " << view.depth_m(v, u) << ", expected "
                      << (expected ? expected->depth_m : 0.0);
      }
    }
  }
  return agreement;
}

/// Compares every `step`th pixel with OctoMap's castRay. The camera must not be inside an occupied leaf.
Agreement compareWithCastRay(const IorView& view, const IorOcTree& tree, int step) {
  const RayDescent oracle(tree.view(), view.camera, view.T_WC, kNear_m, kFar_m);
  const Eigen::Vector3f origin = view.T_WC.translation().cast<float>();
  Agreement agreement;
  for (int v = 0; v < view.camera.height; v += step) {
    for (int u = v % step; u < view.camera.width; u += step) {
      const Eigen::Vector3d p_C = view.camera.unproject(u, v, 1.0);
      const Eigen::Vector3f direction = (view.T_WC.linear() * p_C).cast<float>();
      octomap::point3d end;
      std::optional<LeafKey> expected;
      if (tree.castRay({origin.x(), origin.y(), origin.z()}, {direction.x(), direction.y(), direction.z()}, end, true,
                       (kFar_m + 0.1) * p_C.norm())) {
        const octomap::OcTreeKey key = tree.coordToKey(end);
        expected = LeafKey{key[0], key[1], key[2]};
        if (oracle.inside(*expected, u, v).length() <= 0.0) expected.reset();  // before near or beyond far
      }
      ++agreement.rays;
      const auto found = view.keyAt(u, v);
      if (found == expected) {
        ++agreement.same;
      } else if (isGrazing(oracle, found, expected, u, v)) {
        ++agreement.grazing;
      } else {
        ADD_FAILURE() << "pixel " << u << " " << v << ": hit " << found.has_value() << ", castRay "
                      << expected.has_value();
      }
    }
  }
  return agreement;
}

TEST(RendererOracle, AgreesWithDescentRayByRayOnRandomTrees) {
  std::mt19937 random(11);
  Renderer renderer({.near_m = kNear_m, .far_m = kFar_m});
  Agreement all;
  int hits = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double leaf_size_m = trial % 3 == 0 ? 0.3 : 0.05;
    IorOcTree tree(leaf_size_m);
    test::fillRandomly(tree, random, trial % 2 == 0 ? 8 : 30, 2000);
    tree.setNow({static_cast<std::uint32_t>(random() % 110)});
    const PinholeCamera camera{81, 61, trial % 5 == 0 ? 20.0 : 90.0, 80.0, 38.3, 31.2};
    const IorView& view =
        renderer.renderIor(tree.view(), camera, test::randomPose(random, {0.1, 0.0, 0.0}, 12 * leaf_size_m));
    const Agreement one = compareWithDescent(view, tree.view(), 1);
    all.rays += one.rays;
    all.same += one.same;
    hits += cv::countNonZero(view.depth_m);
  }
  EXPECT_GT(hits, all.rays / 4);
  EXPECT_GT(all.same, 0.999 * all.rays);
  RecordProperty("share_same", std::to_string(static_cast<double>(all.same) / all.rays));
}

TEST(RendererOracle, AgreesWithDescentLookingAlongTheAxesFromPlanesBetweenLeaves) {
  // Directions with zero components, rays that run in planes between leaves: all numbers here are exact in binary.
  constexpr double kExactLeaf_m = 0.0625;
  std::mt19937 random(12);
  IorOcTree tree(kExactLeaf_m);
  test::fillRandomly(tree, random, 12, 1500);
  Renderer renderer({.near_m = kNear_m, .far_m = kFar_m});
  for (const double offset_px : {0.0, 0.25}) {
    const PinholeCamera camera{33, 25, 32.0, 32.0, 16.0 + offset_px, 12.0 + offset_px};
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        Eigen::Vector3d forward = Eigen::Vector3d::Zero(), up = Eigen::Vector3d::Zero();
        forward[axis] = sign;
        up[(axis + 1) % 3] = 1.0;
        for (const Eigen::Vector3d& keys : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2, -1, 5)}) {
          const Pose T_WC = test::lookAlong(kExactLeaf_m * keys, forward, up);
          const Agreement agreement = compareWithDescent(renderer.renderIor(tree.view(), camera, T_WC), tree.view(), 1);
          EXPECT_GT(agreement.same,
                    0.98 * agreement.rays);  // the diagonals run through edges: any answer there is good
        }
      }
    }
  }
}

TEST(RendererOracle, AgreesWithCastRayOnRandomTrees) {
  std::mt19937 random(13);
  Renderer renderer({.near_m = kNear_m, .far_m = kFar_m});
  for (int trial = 0; trial < 10; ++trial) {
    IorOcTree tree(0.05);
    test::fillRandomly(tree, random, 14, 1200);
    const PinholeCamera camera{61, 47, 60.0, 60.0, 30.3, 23.2};
    Pose T_WC = test::randomPose(random, {0.0, 0.0, 0.0}, 0.1);
    T_WC.translation() -= 1.4 * T_WC.linear().col(2);
    const Agreement agreement = compareWithCastRay(renderer.renderIor(tree.view(), camera, T_WC), tree, 1);
    EXPECT_GT(agreement.same, 0.998 * agreement.rays);
  }
}

/// The endpoints of some frames of the kitchen as occupied leaves of 1 cm, as the poses in the data place them.
class KitchenRendering : public testing::Test {
 protected:
  static constexpr int kFrames = 3, kFrameStep = 10;
  const std::filesystem::path folder_ = std::filesystem::path(SACCADE_TEST_DATA_DIR) / "kitchen";
  const PinholeCamera camera_{640, 480, 585.0, 585.0, 320.0, 240.0};
  IorOcTree tree_{0.01};
  std::vector<Pose> poses_;

  void SetUp() override {
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "no data in " << folder_;
    for (int i = 0; i < kFrames; ++i) integrate(i * kFrameStep);
    tree_.updateInnerNodes();
  }

  void integrate(int frame) {
    char stem[32];
    std::snprintf(stem, sizeof stem, "frame-%06d", frame);
    std::ifstream pose_file(folder_ / (std::string(stem) + ".pose.txt"));
    Pose T_WC = Pose::Identity();
    for (int i = 0; i < 16; ++i) pose_file >> T_WC.matrix()(i / 4, i % 4);
    ASSERT_TRUE(pose_file.good());
    poses_.push_back(T_WC);
    const cv::Mat1w depth = cv::imread((folder_ / (std::string(stem) + ".depth.png")).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(depth.size(), cv::Size(640, 480));
    for (int v = 0; v < depth.rows; v += 2) {
      for (int u = 0; u < depth.cols; u += 2) {
        if (depth(v, u) < 300 || depth(v, u) > 4000) continue;
        const Eigen::Vector3d p_W = T_WC * camera_.unproject(u, v, depth(v, u) / 1000.0);
        octomap::OcTreeKey key;
        if (tree_.coordToKeyChecked(p_W.x(), p_W.y(), p_W.z(), key)) tree_.updateNode(key, true, true);
      }
    }
  }
};

TEST_F(KitchenRendering, AgreesWithDescentAndCastRay) {
  Renderer renderer({.near_m = kNear_m, .far_m = kFar_m});
  for (const Pose& T_WC : poses_) {
    const IorView& view = renderer.renderIor(tree_.view(), camera_, T_WC);
    EXPECT_GT(cv::countNonZero(view.depth_m), 640 * 480 / 2);
    const Agreement descent = compareWithDescent(view, tree_.view(), 5);
    EXPECT_GT(descent.same, 0.9995 * descent.rays);
    const Agreement cast_ray = compareWithCastRay(view, tree_, 29);
    EXPECT_GT(cast_ray.same, 0.998 * cast_ray.rays);
  }
}

TEST(RendererOracle, GivesTheSameBytesWithEitherInstructionSetAndEveryTime) {
  if (bestInstructionSet() == InstructionSet::kPortable) GTEST_SKIP() << "this processor or build has one set only";
  std::mt19937 random(14);
  for (int trial = 0; trial < 20; ++trial) {
    IorOcTree tree(0.05);
    test::fillRandomly(tree, random, 20, 3000);
    const PinholeCamera camera{83, 59, 70.0, 75.0, 40.3, 30.2};
    RayGrid rays;
    ASSERT_TRUE(rays.prepare(camera, test::randomPose(random, {0, 0, 0}, 1.0), 0.05, 0.1, 4.0));
    std::vector<std::vector<VisibleLeaf>> leaves;
    std::vector<cv::Mat1f> depths;
    std::vector<cv::Mat1i> indices;
    for (const InstructionSet set : {InstructionSet::kPortable, InstructionSet::kAvx2, InstructionSet::kAvx2}) {
      PixelCanvas canvas;
      depths.emplace_back(59, 83);
      indices.emplace_back(59, 83);
      leaves.emplace_back();
      canvas.reset(depths.back(), indices.back());
      walkOctree(tree.view(), rays, set, canvas, leaves.back());
    }
    for (std::size_t other = 1; other < 3; ++other) {
      ASSERT_EQ(cv::countNonZero(depths[0] != depths[other]), 0);
      ASSERT_EQ(cv::countNonZero(indices[0] != indices[other]), 0);
      ASSERT_EQ(leaves[0].size(), leaves[other].size());
      for (std::size_t i = 0; i < leaves[0].size(); ++i) ASSERT_EQ(leaves[0][i].key, leaves[other][i].key);
    }
  }
}

}  // namespace
}  // namespace saccade
