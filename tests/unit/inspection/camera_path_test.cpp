#include "saccade/inspection/camera_path.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/inspection/scene_frame.hpp"

namespace saccade {
namespace {

constexpr double kRounding = 1e-9;

SceneFrame boxScene() {
  SceneFrame scene;
  scene.box = Eigen::AlignedBox3d(Eigen::Vector3d(-1.0, -2.0, 0.0), Eigen::Vector3d(3.0, 1.0, 5.0));
  return scene;
}

TEST(CameraPath, LookAtPutsTheTargetInTheMiddleAndUpUpwards) {
  const Eigen::Vector3d eye(1.0, 2.0, 3.0), target(-2.0, 0.5, 4.0), up(0.0, -1.0, 0.0);
  const Pose T_WC = lookAt(eye, target, up);
  const Eigen::Vector3d seen = T_WC.inverse() * target;
  EXPECT_NEAR(seen.x(), 0.0, kRounding);
  EXPECT_NEAR(seen.y(), 0.0, kRounding);
  EXPECT_NEAR(seen.z(), (target - eye).norm(), kRounding);
  EXPECT_LT((T_WC.inverse() * (target + up)).y(), 0.0) << "up in the world is up in the picture (v falls)";
  EXPECT_NEAR(T_WC.linear().determinant(), 1.0, kRounding);
}

TEST(CameraPath, LookAtAlongUpIsStillAPoseAndAtItselfIsRefused) {
  const Pose T_WC = lookAt({0, 0, 0}, {0, 5, 0}, {0, -1, 0});
  EXPECT_NEAR((T_WC.linear() * T_WC.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, kRounding);
  EXPECT_THROW((void)lookAt({1, 1, 1}, {1, 1, 1}, {0, -1, 0}), std::invalid_argument);
}

TEST(CameraPath, ATurntableSeesEveryCornerOfTheSceneFromEverywhere) {
  const PinholeCamera camera = cameraWithFov(640, 360, 1.0);
  const SceneFrame scene = boxScene();
  for (const Pose& T_WC : turntable(scene, camera, 12)) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner = T_WC.inverse() * scene.box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
      ASSERT_GT(corner.z(), 0.0);
      const Eigen::Vector2d pixel = camera.project(corner);
      EXPECT_GE(pixel.minCoeff(), -0.5);
      EXPECT_LE(pixel.x(), camera.width - 0.5);
      EXPECT_LE(pixel.y(), camera.height - 0.5);
    }
  }
}

TEST(CameraPath, AFlyThroughBeginsAndEndsWhereThePathDoesAndKeepsAStraightPathStraight) {
  std::vector<Pose> path;
  for (int i = 0; i <= 20; ++i) path.push_back(Pose(Eigen::Translation3d(0.1 * i, 0.0, 0.0)));
  const std::vector<Pose> film = flyThrough(path, 41);
  ASSERT_EQ(film.size(), 41u);
  EXPECT_NEAR((film.front().translation() - path.front().translation()).norm(), 0.0, kRounding);
  EXPECT_NEAR((film.back().translation() - path.back().translation()).norm(), 0.0, kRounding);
  for (std::size_t i = 1; i < film.size(); ++i) {
    EXPECT_GT(film[i].translation().x(), film[i - 1].translation().x());
    EXPECT_NEAR(film[i].translation().y(), 0.0, kRounding);
  }
}

TEST(CameraPath, PosesAreReadWithBlanksOrCommasAndAnythingElseIsRefused) {
  const Pose T_WC = parsePose("1, 2, 3, 0, 0, 0, 2");
  EXPECT_NEAR((T_WC.matrix() - Pose(Eigen::Translation3d(1, 2, 3)).matrix()).norm(), 0.0, kRounding);
  for (const char* wrong : {"", "1 2", "1 2 3 4", "1 2 3 0 0 0 0", "1 2 x", "1 2 nan", "1 2 3 0 0 0 1 9"}) {
    EXPECT_THROW((void)parsePose(wrong), std::invalid_argument) << wrong;
  }
}

}  // namespace
}  // namespace saccade
