#include "saccade/simulation/simulated_world.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "saccade/simulation/scene_renderer.hpp"
#include "saccade/simulation/simulated_source.hpp"

namespace saccade {
namespace {

struct Outline {
  std::vector<cv::Point2f> hull;
  float z_low = 1e9f, z_high = -1e9f;
};

std::map<int, Outline> outlinesOf(const Scene& scene) {
  std::map<int, Outline> outlines;
  for (const Surface& surface : scene.surfaces()) {
    if (surface.object_id == 0) continue;
    Outline& outline = outlines[surface.object_id];
    for (const Eigen::Vector3f& p : surface.mesh.vertices) {
      outline.hull.emplace_back(p.x(), p.y());
      outline.z_low = std::min(outline.z_low, p.z());
      outline.z_high = std::max(outline.z_high, p.z());
    }
  }
  for (auto& [id, outline] : outlines) {
    std::vector<cv::Point2f> hull;
    cv::convexHull(outline.hull, hull);
    outline.hull = hull;
  }
  return outlines;
}

class EveryScene : public testing::TestWithParam<const char*> {};

TEST_P(EveryScene, KeepsItsObjectsApart) {
  constexpr float kStandsOn_m = 1e-3f;
  constexpr float kTouch_m2 = 1e-6f;  // of rounding in the intersection
  for (const std::uint64_t seed : {0, 1, 2}) {
    const SimulatedWorld world = makeWorld(*findSceneKind(GetParam()), seed);
    const auto outlines = outlinesOf(world.scene);
    EXPECT_EQ(outlines.size(), world.scene.objects().size());
    for (auto a = outlines.begin(); a != outlines.end(); ++a) {
      for (auto b = std::next(a); b != outlines.end(); ++b) {
        if (a->second.z_low > b->second.z_high - kStandsOn_m || b->second.z_low > a->second.z_high - kStandsOn_m)
          continue;
        const cv::Rect2f box_a = cv::boundingRect(a->second.hull), box_b = cv::boundingRect(b->second.hull);
        std::vector<cv::Point2f> common;
        EXPECT_LE(cv::intersectConvexConvex(a->second.hull, b->second.hull, common), kTouch_m2)
            << GetParam() << " seed " << seed << ": " << a->first << " and " << b->first << " at " << box_a << box_b;
      }
    }
  }
}

TEST_P(EveryScene, RestsEveryObjectOnSomething) {
  const SimulatedWorld world = makeWorld(*findSceneKind(GetParam()), 3);
  const auto outlines = outlinesOf(world.scene);
  // Heights of level ground: of background surfaces that face up, and of the tops of objects.
  std::vector<float> levels;
  for (const Surface& surface : world.scene.surfaces()) {
    if (surface.object_id != 0) continue;
    for (std::size_t i = 0; i < surface.mesh.vertices.size(); ++i) {
      if (surface.mesh.normals[i].z() > 0.99f) levels.push_back(surface.mesh.vertices[i].z());
    }
  }
  for (const auto& [id, outline] : outlines) levels.push_back(outline.z_high);
  for (const auto& [id, outline] : outlines) {
    const bool rests = std::any_of(levels.begin(), levels.end(),
                                   [&, low = outline.z_low](float level) { return std::abs(level - low) < 1e-3f; });
    EXPECT_TRUE(rests) << "object " << id << " floats at " << outline.z_low;
  }
}

TEST_P(EveryScene, MovesTheCameraLikeACarefulPerson) {
  const SceneKind& kind = *findSceneKind(GetParam());
  for (const std::uint64_t seed : {0, 1, 2}) {
    const SimulatedWorld world = makeWorld(kind, seed);
    double travelled_m = 0;
    for (std::int64_t frame = 0; frame < kind.default_frames; ++frame) {
      const Pose step = world.cameraPose(frame).inverse() * world.cameraPose(frame + 1);
      ASSERT_LT(step.translation().norm(), 0.02) << "seed " << seed << ", frame " << frame;
      ASSERT_LT(Eigen::AngleAxisd(step.linear()).angle(), 1.5 * M_PI / 180) << "seed " << seed << ", frame " << frame;
      travelled_m += step.translation().norm();
    }
    EXPECT_GT(travelled_m, 0.4) << "the camera should see the scene from several sides";
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryScene, testing::Values("desk", "coffee", "office", "flat", "plain"));

TEST(SceneKinds, HoldTheirNumberOfObjects) {
  for (const std::uint64_t seed : {0, 5, 6}) {
    EXPECT_EQ(makeWorld(*findSceneKind("desk"), seed).scene.objects().size(), 12u) << seed;
    EXPECT_EQ(makeWorld(*findSceneKind("coffee"), seed).scene.objects().size(), 80u) << seed;
    EXPECT_EQ(makeWorld(*findSceneKind("office"), seed).scene.objects().size(), 70u) << seed;
    EXPECT_EQ(makeWorld(*findSceneKind("flat"), seed).scene.objects().size(), 300u) << seed;
    EXPECT_EQ(makeWorld(*findSceneKind("plain"), seed).scene.objects().size(), 0u) << seed;
  }
  EXPECT_EQ(findSceneKind("moon"), nullptr);
}

TEST(FlatScene, ReturnsToItsStart) {
  constexpr double kTremor_m = 0.01;  // the hand's tremor goes on after the loop
  for (const std::uint64_t seed : {0, 1, 2}) {
    const SimulatedWorld world = makeWorld(*findSceneKind("flat"), seed);
    const Eigen::Vector3d start = world.cameraPose(0).translation(), end = world.cameraPose(6000).translation();
    EXPECT_LT((start - end).norm(), kTremor_m) << seed;
    EXPECT_GT((start - world.cameraPose(3000).translation()).norm(), 3.0) << seed;
  }
}

TEST(OfficeScene, LaysPapersOverOneAnother) {
  for (const std::uint64_t seed : {0, 1, 2, 3}) {
    const Scene scene = makeWorld(*findSceneKind("office"), seed).scene;
    const auto outlines = outlinesOf(scene);
    int covered = 0;
    for (const SceneObject& lower : scene.objects()) {
      if (lower.kind != "sheet" && lower.kind != "magazine") continue;
      for (const auto& [id, upper] : outlines) {
        std::vector<cv::Point2f> common;
        if (upper.z_low > outlines.at(lower.id).z_low + 1e-3f &&
            cv::intersectConvexConvex(outlines.at(lower.id).hull, upper.hull, common) > 1e-3f) {
          ++covered;
          break;
        }
      }
    }
    EXPECT_GE(covered, 1) << seed;
  }
}

/// Objects with at least `least` of the full image's pixels, on an image reduced by 4.
int visibleObjects(const cv::Mat1w& label, int least) {
  std::map<int, int> pixels;
  for (const ushort id : label) ++pixels[id];
  return static_cast<int>(std::count_if(
      pixels.begin(), pixels.end(), [&](const auto& entry) { return entry.first != 0 && 16 * entry.second >= least; }));
}

TEST(CoffeeScene, ShowsAsManyObjectsAsThePapersSequence) {
  constexpr int kLeastPixels = 200;
  for (const std::uint64_t seed : {0, 1, 2}) {
    SimulatedWorld world = makeWorld(*findSceneKind("coffee"), seed);
    const SceneRenderer renderer(std::move(world.scene), simulatedCamera().reducedBy(4));
    SceneImages images;
    int sum = 0, most = 0, frames = 0;
    std::set<int> seen;
    for (std::int64_t frame = 0; frame < 436; frame += 12, ++frames) {
      renderer.render(world.cameraPose(frame), images);
      const int visible = visibleObjects(images.label, kLeastPixels);
      sum += visible;
      most = std::max(most, visible);
      seen.insert(images.label.begin(), images.label.end());
    }
    RecordProperty("mean_visible_seed_" + std::to_string(seed), std::to_string(static_cast<double>(sum) / frames));
    EXPECT_NEAR(static_cast<double>(sum) / frames, 36, 6) << "seed " << seed;
    EXPECT_NEAR(most, 48, 6) << "seed " << seed;
    EXPECT_GE(seen.size(), 65u) << "most of the 80 come into view, seed " << seed;
  }
}

TEST(DeskScene, ShowsMostOfItsObjectsInEveryFrame) {
  for (const std::uint64_t seed : {0, 1, 2}) {
    SimulatedWorld world = makeWorld(*findSceneKind("desk"), seed);
    const SceneRenderer renderer(std::move(world.scene), simulatedCamera().reducedBy(4));
    SceneImages images;
    for (std::int64_t frame = 0; frame < 120; frame += 30) {
      renderer.render(world.cameraPose(frame), images);
      EXPECT_GE(visibleObjects(images.label, 200), 8) << "seed " << seed << ", frame " << frame;
      EXPECT_EQ(cv::countNonZero(images.depth_m), images.depth_m.size().area()) << "the room is closed";
    }
  }
}

}  // namespace
}  // namespace saccade
