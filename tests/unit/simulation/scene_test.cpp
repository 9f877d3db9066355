#include "saccade/simulation/scene.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "saccade/simulation/scene_renderer.hpp"
#include "saccade/simulation/simulated_world.hpp"
#include "simulation/mesh_shapes.hpp"

namespace saccade {
namespace {

using Eigen::Vector3d;

// Vertices are floats of a few metres, and so is the depth.
constexpr double kFloatDepth = 1e-6;

const PinholeCamera kCamera{160, 120, 130, 131, 80.3, 58.7};

cv::Mat3b grey() {
  return cv::Mat3b(4, 4, cv::Vec3b(180, 180, 180));
}

/// World and camera axes agree: the scene lies before the camera along z.
SceneImages renderFromOrigin(Scene scene) {
  SceneImages images;
  SceneRenderer(std::move(scene), kCamera).render(Pose::Identity(), images);
  return images;
}

TEST(SceneRenderer, MeasuresASlantedWallExactly) {
  Scene scene;
  const int texture = scene.addTexture(grey());
  const Eigen::Vector3f corner(-4, -4, 1.5f), right(8, 0, 2), down(0, 8, 1);
  scene.addBackground(makeRectangle(corner, right, down, 0.5f), {texture, 0});
  const Vector3d normal = right.cross(down).cast<double>();
  const SceneImages images = renderFromOrigin(std::move(scene));
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Vector3d ray = kCamera.unproject(u, v, 1.0);
      const double expected = normal.dot(corner.cast<double>()) / normal.dot(ray);
      ASSERT_NEAR(images.depth_m(v, u), expected, 3 * kFloatDepth * expected) << u << ", " << v;
      ASSERT_NEAR(images.cosine(v, u), std::abs(normal.normalized().dot(ray.normalized())), 1e-5);
    }
  }
}

TEST(SceneRenderer, LabelsTheBoxAndTheWallBehindItExactly) {
  Scene scene;
  const int texture = scene.addTexture(grey());
  scene.addBackground(makeRectangle({-4, -4, 3}, {8, 0, 0}, {0, 8, 0}, 1.0f), {texture, 0});
  const int first = scene.addObject("box");
  // Standing on z = 1, that is with its bottom at 1 m before the camera.
  Mesh box = makeBox({0.4f, 0.3f, 0.5f});
  box.transform(Pose(Eigen::Translation3d(0.1, 0.05, 1.0)));
  scene.add({box, {texture, 0}, first});
  const SceneImages images = renderFromOrigin(std::move(scene));
  int on_box = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Vector3d ray = kCamera.unproject(u, v, 1.0);
      // The sides of the box are hidden behind its face, whose outline the rays at 1 m decide.
      const double x = std::abs(ray.x() - 0.1), y = std::abs(ray.y() - 0.05);
      if (std::abs(x - 0.2) < 1e-6 || std::abs(y - 0.15) < 1e-6) continue;
      bool hit = x < 0.2 && y < 0.15;
      ASSERT_EQ(images.label(v, u), hit ? first : 0) << u << ", " << v;
      ASSERT_NEAR(images.depth_m(v, u), hit ? 1.0 : 3.0, 3e-6);
      on_box += hit ? 1 : 0;
    }
  }
  EXPECT_GT(on_box, 1000);
}

TEST(SceneRenderer, SeesABallWhereABallIs) {
  Scene scene;
  const int texture = scene.addTexture(grey());
  const int id = scene.addObject("ball");
  constexpr double kRadius = 0.5, kDistance = 2.0;
  Mesh ball = makeEllipsoid({0.5f, 0.5f, 0.5f});
  ball.transform(Pose(Eigen::Translation3d(0, 0, kDistance - kRadius)));
  scene.add({ball, {texture, 0}, id});
  const SceneImages images = renderFromOrigin(std::move(scene));
  // 14 pieces from pole to pole: chords stay within r (1 - cos(pi / 28)) of the arc; seen up to 45 degrees off.
  const double chord_m = kRadius * (1 - std::cos(M_PI / 24)) * 2;
  int compared = 0;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Vector3d ray = kCamera.unproject(u, v, 1.0), middle(0, 0, kDistance);
      const double a = ray.squaredNorm(), b = ray.dot(middle), c = middle.squaredNorm() - kRadius * kRadius;
      if (b * b - a * c < 0) {
        ASSERT_EQ(images.depth_m(v, u), 0.0f);
        continue;
      }
      const double t = (b - std::sqrt(b * b - a * c)) / a;
      const Vector3d normal = (t * ray - middle) / kRadius;
      if (-normal.dot(ray.normalized()) < 0.7) continue;
      ASSERT_NEAR(images.depth_m(v, u), t, chord_m);
      ASSERT_EQ(images.label(v, u), id);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

struct Nearest {
  double t = std::numeric_limits<double>::infinity();
  int object_id = 0;
};

/// Every triangle, one by one, in double precision.
Nearest castByHand(const Scene& scene, const Vector3d& origin, const Vector3d& ray) {
  Nearest nearest;
  for (const Surface& surface : scene.surfaces()) {
    for (const auto& [i, j, k] : surface.mesh.triangles) {
      const Vector3d a = surface.mesh.vertices[i].cast<double>();
      const Vector3d e1 = surface.mesh.vertices[j].cast<double>() - a, e2 = surface.mesh.vertices[k].cast<double>() - a;
      const Vector3d p = ray.cross(e2);
      const double determinant = e1.dot(p);
      if (determinant == 0) continue;
      const Vector3d s = origin - a;
      const double u = s.dot(p) / determinant;
      if (u < 0 || u > 1) continue;
      const Vector3d q = s.cross(e1);
      const double v = ray.dot(q) / determinant, t = e2.dot(q) / determinant;
      if (v >= 0 && u + v <= 1 && t > 0 && t < nearest.t) nearest = {t, surface.object_id};
    }
  }
  return nearest;
}

TEST(SceneRenderer, EqualsCastingEveryTriangleByHand) {
  const SimulatedWorld world = makeWorld(*findSceneKind("desk"), 4);
  const PinholeCamera camera{40, 30, 33, 33, 19.4, 14.6};
  const SceneRenderer renderer(world.scene, camera);
  SceneImages images;
  const Pose T_WC = world.cameraPose(37);
  renderer.render(T_WC, images);
  int differ = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Nearest hit = castByHand(world.scene, T_WC.translation(), T_WC.linear() * camera.unproject(u, v, 1.0));
      const bool same = std::abs(static_cast<double>(images.depth_m(v, u)) - hit.t) < 3e-5 * hit.t &&
                        images.label(v, u) == hit.object_id;
      differ += same ? 0 : 1;
    }
  }
  // Rays in single precision may pass an outline on its other side; such pixels are rare.
  EXPECT_LE(differ, 2);
}

TEST(SceneRenderer, DrawsShadowsWhereTheLampIsHidden) {
  Scene scene;
  const int texture = scene.addTexture(grey());
  scene.addLamp({Vector3d(0, 0, 3), 0.02, 0.8, 10.0});
  scene.addBackground(makeRectangle({-3, 3, 0}, {6, 0, 0}, {0, -6, 0}, 0.05f), {texture, 0});
  Mesh ball = makeEllipsoid({0.1f, 0.1f, 0.1f});
  ball.transform(Pose(Eigen::Translation3d(0.5, 0, 0.9)));
  scene.addBackground(ball, {texture, 0});
  // Looks down from beside the lamp; the shadow of (0.5, 0, 1) falls on (0.75, 0, 0).
  Pose T_WC = Pose::Identity();
  T_WC.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix();
  T_WC.translation() = Vector3d(2, 0, 2);
  const PinholeCamera camera{400, 300, 200, 200, 200, 150};
  SceneImages images;
  SceneRenderer(std::move(scene), camera).render(T_WC, images);
  const auto brightness = [&](double x, double y) {
    const Eigen::Vector2d pixel = camera.project(T_WC.inverse() * Vector3d(x, y, 0));
    return static_cast<int>(images.color(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()))[0]);
  };
  EXPECT_LT(brightness(0.75, 0), 0.85 * brightness(1.2, 0));
  EXPECT_LT(brightness(0.75, 0), 0.85 * brightness(0.75, 0.4));
}

TEST(SceneRenderer, GivesTheSameBytesWithOneThread) {
  const SimulatedWorld world = makeWorld(*findSceneKind("desk"), 1);
  SceneImages many, one;
  SceneRenderer(world.scene, kCamera).render(world.cameraPose(5), many);
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    SceneRenderer(world.scene, kCamera).render(world.cameraPose(5), one);
  }
  EXPECT_TRUE(std::equal(many.color.datastart, many.color.dataend, one.color.datastart));
  EXPECT_TRUE(std::equal(many.depth_m.datastart, many.depth_m.dataend, one.depth_m.datastart));
  EXPECT_TRUE(std::equal(many.label.datastart, many.label.dataend, one.label.datastart));
}

TEST(SceneRenderer, ShowsNothingInAnEmptyScene) {
  const SceneImages images = renderFromOrigin(Scene());
  EXPECT_EQ(cv::countNonZero(images.depth_m), 0);
  EXPECT_EQ(cv::countNonZero(images.label), 0);
}

TEST(Scene, RefusesWhatDoesNotFitTogether) {
  Scene scene;
  EXPECT_THROW(scene.addTexture({}), std::invalid_argument);
  EXPECT_THROW(scene.addBackground(makeBox({1, 1, 1}), {0, 0}), std::invalid_argument) << "no texture yet";
  const int texture = scene.addTexture(grey());
  EXPECT_THROW(scene.add({makeBox({1, 1, 1}), {texture, 0}, 1}), std::invalid_argument) << "no object yet";
  Mesh torn = makeBox({1, 1, 1}), lost = torn, endless = torn;
  torn.uv.pop_back();
  lost.triangles[0][1] = 100000;
  endless.vertices[3].x() = std::nanf("");
  for (const Mesh& bad : {torn, lost, endless}) {
    EXPECT_THROW(scene.addBackground(bad, {texture, 0}), std::invalid_argument);
  }
  EXPECT_NO_THROW(scene.addBackground(makeBox({1, 1, 1}), {texture, 0}));
  EXPECT_THROW(SceneRenderer(scene, PinholeCamera{}), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
