#include "saccade/simulation/scene.hpp"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/simulation/scene_renderer.hpp"
#include "saccade/simulation/simulated_source.hpp"

namespace saccade {
namespace {

using Eigen::Vector3d;

constexpr double kExact_m = 1e-9;       // double arithmetic at room scale
constexpr double kFloatDepth = 2.5e-7;  // relative: depth images are single precision

/// How far a point is from the surface, in the primitive's own frame; written apart from the ray intersections.
double distanceToSurface(const Primitive& primitive, const Vector3d& p_W) {
  const Vector3d p = primitive.T_WO.inverse() * p_W;
  const Vector3d half = primitive.half_size_m;
  switch (primitive.shape) {
    case Shape::kSphere:
      return std::abs(p.norm() - half.x());
    case Shape::kRectangle:
      return std::max({std::abs(p.z()), std::abs(p.x()) - half.x(), std::abs(p.y()) - half.y()});
    case Shape::kCylinder:
      return std::abs(std::max(std::hypot(p.x(), p.y()) - half.x(), std::abs(p.z()) - half.z()));
    case Shape::kBox:
      break;
  }
  return std::abs((p.cwiseAbs() - half).maxCoeff());
}

TEST(Scene, CastsAxisAlignedShapesAtTheirExactDistance) {
  const Vector3d origin(0, 0, -2), ahead(0, 0, 1);
  for (const auto& [shape, expected] :
       {std::pair{Shape::kRectangle, 2.0}, {Shape::kBox, 1.7}, {Shape::kCylinder, 1.7}, {Shape::kSphere, 1.9}}) {
    Scene scene;
    scene.add({shape, Pose::Identity(), Vector3d(0.1, 0.2, 0.3), {}, 7});
    const auto hit = scene.cast({origin, ahead});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, expected, kExact_m);
    EXPECT_TRUE(hit->normal_W.isApprox(-ahead));
    EXPECT_EQ(hit->object_id, 7);
    EXPECT_FALSE(scene.cast({origin, -ahead})) << "nothing is behind the ray";
    EXPECT_FALSE(scene.cast({origin + Vector3d(0.5, 0, 0), ahead}));
  }
}

TEST(Scene, SeesClosedShapesFromWithin) {
  for (const Shape shape : {Shape::kBox, Shape::kCylinder, Shape::kSphere}) {
    Scene scene;
    scene.add({shape, Pose::Identity(), Vector3d(0.5, 0.5, 0.5), {}, 0});
    const auto hit = scene.cast({Vector3d::Zero(), Vector3d(1, 0, 0)});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 0.5, kExact_m);
    EXPECT_TRUE(hit->normal_W.isApprox(Vector3d(-1, 0, 0)));
  }
}

TEST(Scene, HitsLieOnTheSurfaceAndTheRayIsFreeBeforeThem) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vector3d(unit(random), unit(random), unit(random)); };
  int hits = 0;
  for (int round = 0; round < 400; ++round) {
    const Shape shape = static_cast<Shape>(round % 4);
    Pose T_WO = Pose::Identity();
    T_WO.translation() = 0.3 * vector();
    T_WO.linear() = Eigen::AngleAxisd(3 * unit(random), vector().normalized()).toRotationMatrix();
    const Primitive primitive{shape, T_WO, 0.4 * vector().cwiseAbs() + Vector3d::Constant(0.05), {}, 1};
    Scene scene;
    scene.add(primitive);
    const Vector3d origin = 3 * vector().normalized();
    const Ray ray{origin, (0.3 * vector() - origin)};
    const auto hit = scene.cast(ray);
    if (!hit) {
      if (shape == Shape::kRectangle) continue;
      for (double t = 0; t < 2; t += 0.01) {
        ASSERT_GT(distanceToSurface(primitive, ray.origin_W + t * ray.direction_W), 0)
            << "missed a shape it goes through";
      }
      continue;
    }
    ++hits;
    EXPECT_LT(distanceToSurface(primitive, hit->p_W), kExact_m);
    EXPECT_LT(hit->normal_W.dot(ray.direction_W), 0);
    EXPECT_NEAR(hit->normal_W.norm(), 1.0, kExact_m);
    // A step along the normal leaves the surface by that step, so the normal is that of the surface.
    constexpr double kStep_m = 1e-4;
    EXPECT_NEAR(distanceToSurface(primitive, hit->p_W + kStep_m * hit->normal_W), kStep_m, 1e-7);
    if (shape == Shape::kRectangle) continue;
    const Vector3d centre = T_WO.translation();
    for (double share = 0; share < 0.99; share += 0.02) {
      const Vector3d before = ray.origin_W + share * hit->t * ray.direction_W;
      const Vector3d p = T_WO.inverse() * before;
      const bool inside = shape == Shape::kSphere ? (before - centre).norm() < primitive.half_size_m.x()
                          : shape == Shape::kBox  ? (p.cwiseAbs() - primitive.half_size_m).maxCoeff() < 0
                                                  : std::hypot(p.x(), p.y()) < primitive.half_size_m.x() &&
                                                       std::abs(p.z()) < primitive.half_size_m.z();
      ASSERT_FALSE(inside) << "the ray is inside before its first hit";
    }
  }
  EXPECT_GT(hits, 150);
}

TEST(Scene, RefusesSizesThatAreNone) {
  Scene scene;
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(scene.add({Shape::kSphere, Pose::Identity(), Vector3d(bad, 1, 1), {}, 0}), std::invalid_argument);
    EXPECT_THROW(scene.add({Shape::kBox, Pose::Identity(), Vector3d(1, 1, bad), {}, 0}), std::invalid_argument);
  }
  EXPECT_NO_THROW(scene.add({Shape::kRectangle, Pose::Identity(), Vector3d(1, 1, 0), {}, 0}));
}

TEST(SceneRenderer, EqualsCastingEveryPixelByItself) {
  const Scene scene = makeDeskScene(4);
  const PinholeCamera camera{161, 119, 130, 131, 80.3, 58.7};  // no whole number of tiles
  SceneRenderer renderer(scene, camera);
  SceneImages images;
  for (const std::int64_t frame : {0, 37, 90}) {
    const Pose T_WC = deskCameraPose(4, frame);
    renderer.render(T_WC, images);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const auto hit = scene.cast({T_WC.translation(), T_WC.linear() * camera.unproject(u, v, 1.0)});
        ASSERT_TRUE(hit) << "the room is closed";
        ASSERT_NEAR(images.depth_m(v, u), hit->t, kFloatDepth * hit->t) << u << ", " << v;
        ASSERT_EQ(images.label(v, u), hit->object_id);
        ASSERT_NEAR(images.cosine(v, u), -hit->normal_W.dot((hit->p_W - T_WC.translation()).normalized()), 1e-5);
      }
    }
  }
}

TEST(SceneRenderer, DrawsShadowsWhereTheLampIsHidden) {
  Scene scene;
  scene.setLamp(Vector3d(0, 0, 3));
  Pose floor = Pose::Identity();
  scene.add({Shape::kRectangle, floor, Vector3d(5, 5, 0), {}, 0});
  Pose ball = Pose::Identity();
  ball.translation() = Vector3d(0.5, 0, 1);
  scene.add({Shape::kSphere, ball, Vector3d(0.1, 0, 0), {}, 1});
  // Looks down from beside the lamp; the shadow of (0.5, 0, 1) falls on (0.75, 0, 0).
  Pose T_WC = Pose::Identity();
  T_WC.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix();
  T_WC.translation() = Vector3d(2, 0, 2);
  const PinholeCamera camera{400, 300, 200, 200, 200, 150};
  SceneRenderer renderer(scene, camera);
  SceneImages images;
  renderer.render(T_WC, images);
  const auto brightness = [&](double x, double y) {
    const Eigen::Vector2d pixel = camera.project(T_WC.inverse() * Vector3d(x, y, 0));
    return static_cast<int>(images.color(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()))[0]);
  };
  EXPECT_LT(brightness(0.75, 0), 0.8 * brightness(1.2, 0));
  EXPECT_LT(brightness(0.75, 0), 0.8 * brightness(0.75, 0.4));
}

}  // namespace
}  // namespace saccade
