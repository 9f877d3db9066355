#include "saccade/exchange/surface_merge.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/depth_scene.hpp"

namespace saccade {
namespace {

SurfaceVolume volumeSeenFrom(const Pose& T_WC) {
  SurfaceVolumeConfig config;
  config.cell_m = 0.02;
  SurfaceVolume volume(config);
  DepthMaps depth;
  const PinholeCamera camera = test::smallCamera();
  DepthPreparation().prepare(test::cornerWithBalls().render(camera, T_WC), camera, depth);
  volume.integrate(depth, T_WC);
  return volume;
}

bool sameBricks(const SurfaceVolume& a, const SurfaceVolume& b) {
  if (a.bricks().size() != b.bricks().size()) return false;
  for (std::size_t i = 0; i < a.bricks().size(); ++i) {
    const auto found = std::find(b.bricks().begin(), b.bricks().end(), a.bricks()[i]);
    if (found == b.bricks().end()) return false;
    const SurfaceBrick& other = b.brick(static_cast<std::size_t>(found - b.bricks().begin()));
    if (a.brick(i).distance != other.distance || a.brick(i).weight != other.weight) return false;
  }
  return true;
}

TEST(MergeSurface, OfOneVolumeIntoAnEmptyOneIsTheVolume) {
  const SurfaceVolume volume = volumeSeenFrom(Pose::Identity());
  SurfaceVolume merged(volume.config());
  mergeSurface(volume, Pose::Identity(), merged);
  // Bricks that hold nothing known are not carried over.
  SurfaceVolume again(volume.config());
  mergeSurface(merged, Pose::Identity(), again);
  EXPECT_TRUE(sameBricks(merged, again));
  for (std::size_t i = 0; i < merged.bricks().size(); ++i) {
    const auto found = std::find(volume.bricks().begin(), volume.bricks().end(), merged.bricks()[i]);
    ASSERT_NE(found, volume.bricks().end());
    EXPECT_EQ(merged.brick(i).distance,
              volume.brick(static_cast<std::size_t>(found - volume.bricks().begin())).distance);
  }
}

TEST(MergeSurface, AnEmptyVolumeAddsNothing) {
  const SurfaceVolume volume = volumeSeenFrom(Pose::Identity());
  SurfaceVolume merged = volumeSeenFrom(Pose::Identity());
  mergeSurface(SurfaceVolume(volume.config()), Pose::Identity(), merged);
  EXPECT_TRUE(sameBricks(volume, merged));
}

TEST(MergeSurface, FromAnotherFrameTheSurfaceLiesWhereItIs) {
  const test::DepthScene scene = test::cornerWithBalls();
  const Pose T_IF = test::poseOf({1, 2, 3}, 25.0, {0.4, -0.2, 0.1});
  const SurfaceVolume original = volumeSeenFrom(Pose::Identity());
  SurfaceVolume merged(original.config());
  mergeSurface(original, T_IF, merged);
  int known_before = 0, known_after = 0;
  double sum_m = 0.0;
  for (int v = 10; v < test::smallCamera().height - 10; v += 4) {
    for (int u = 10; u < test::smallCamera().width - 10; u += 4) {
      const double depth_m = scene.meetPixel(test::smallCamera(), Pose::Identity(), u, v).s;
      const Eigen::Vector3d p_F = test::smallCamera().unproject(u, v, depth_m);
      if (!original.distanceAt(p_F)) continue;
      ++known_before;
      const auto distance_m = merged.distanceAt(T_IF * p_F);
      if (!distance_m) continue;
      ++known_after;
      sum_m += std::abs(*distance_m);
    }
  }
  ASSERT_GT(known_before, 300);
  EXPECT_GT(known_after, known_before * 8 / 10);  // interpolation wants all eight samples around: rims are lost
  constexpr double kQuarterOfACell_m = 0.005;     // interpolated twice, of one view of a quarter of the resolution
  EXPECT_LT(sum_m / known_after, kQuarterOfACell_m);
}

}  // namespace
}  // namespace saccade
