#include "saccade/pipeline/placement.hpp"

#include <gtest/gtest.h>

#include "support/painted_room.hpp"

namespace saccade {
namespace {

using test::PaintedRoom;
using test::poseOf;

constexpr double kPlaceError_m = 0.01;

PinholeCamera camera() {
  return {320, 240, 292.5, 292.5, 159.5, 119.5};
}

RgbdFrame seenFrom(const Pose& T_WC, std::int64_t index, std::uint32_t paint = 1) {
  PaintedRoom room;
  room.seed = paint;
  RgbdFrame frame = room.photograph(camera(), T_WC);
  frame.index = {index};
  frame.stamp_s = static_cast<double>(index) / 30.0;
  return frame;
}

Pose along(double step) {
  return poseOf({0, 1, 0}, -12.0 + 8.0 * step, {0.05 * step, 0.0, 0.0});
}

/// An explorer that has been past the room once; at the end it looks from along(3).
struct Explored {
  Explorer explorer{ExplorerConfig{}, camera()};

  Explored() {
    for (int i = 0; i < 4; ++i) (void)explorer.processAt(seenFrom(along(i), i), along(i));
  }
};

double distance(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}

TEST(Explorer, RemembersKeyframesAndReportsThem) {
  Explorer explorer(ExplorerConfig{}, camera());
  const FrameReport first = explorer.processAt(seenFrom(along(0), 0), along(0));
  ASSERT_TRUE(first.keyframe);
  EXPECT_GT(first.keyframe->features.size(), 100U);
  EXPECT_EQ(first.keyframe->T_WC.matrix(), along(0).matrix());
  EXPECT_FALSE(explorer.processAt(seenFrom(along(0.5), 1), along(0.5)).keyframe);  // 4 degrees farther: known
  EXPECT_TRUE(explorer.processAt(seenFrom(along(3), 2), along(3)).keyframe);
  EXPECT_EQ(explorer.keyframes().all().size(), 2U);
}

TEST(Explorer, WritesNothingWhileLostAndGoesOnWhereItIsFoundAgain) {
  Explored explored;
  Explorer& explorer = explored.explorer;
  const Tick before = explorer.map().now();
  const std::int64_t leaves = static_cast<std::int64_t>(explorer.map().leafCount());
  RgbdFrame covered = seenFrom(along(3), 4);
  covered.color.setTo(cv::Scalar::all(30));
  covered.depth_m.setTo(0.0F);  // a hand before the camera
  EXPECT_EQ(explorer.process(covered).tracking.status, TrackingStatus::kLost);
  EXPECT_EQ(explorer.map().now(), before);
  EXPECT_EQ(static_cast<std::int64_t>(explorer.map().leafCount()), leaves);

  // Rolled by 40 degrees meanwhile, which no alignment from the last pose can follow.
  const Pose elsewhere = along(0.2) * poseOf({0, 0, 1}, 40.0, {0, 0, 0});
  const FrameReport found = explorer.process(seenFrom(elsewhere, 5));
  EXPECT_TRUE(found.relocalised);
  EXPECT_EQ(found.tracking.status, TrackingStatus::kTracked);
  EXPECT_LT(distance(found.tracking.T_WC, elsewhere), kPlaceError_m);
  EXPECT_EQ(explorer.map().now().value, before.value + 1);
  const FrameReport next = explorer.process(seenFrom(elsewhere, 6));
  EXPECT_FALSE(next.relocalised);
  EXPECT_LT(distance(next.tracking.T_WC, elsewhere), kPlaceError_m);
}

TEST(Placement, IsTentativeFirstAndVerifiedWhenTheNextFramesConfirmIt) {
  Explored explored;
  Placement placement(explored.explorer);
  const Tick before = explored.explorer.map().now();
  EXPECT_EQ(placement.state(), PlacementState::kUnlocalised);
  EXPECT_EQ(placement.offer(seenFrom(along(1.2), 100)), PlacementState::kTentative);
  EXPECT_EQ(placement.offer(seenFrom(along(1.3), 101)), PlacementState::kTentative);
  EXPECT_EQ(placement.offer(seenFrom(along(1.4), 102)), PlacementState::kVerified);
  EXPECT_EQ(explored.explorer.map().now(), before);
  const FrameReport report = explored.explorer.process(seenFrom(along(1.4), 102));
  EXPECT_EQ(report.tracking.status, TrackingStatus::kTracked);
  EXPECT_FALSE(report.relocalised);
  EXPECT_LT(distance(report.tracking.T_WC, along(1.4)), kPlaceError_m);
  EXPECT_EQ(report.tick.value, before.value + 1);
}

TEST(Placement, StaysUnlocalisedInAnotherPlaceAndEditsNothing) {
  Explored explored;
  Explorer& explorer = explored.explorer;
  const Tick before = explorer.map().now();
  const std::uint64_t surface = explorer.surface().changes();
  Placement placement(explorer);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(placement.offer(seenFrom(along(i), 100 + i, 2)), PlacementState::kUnlocalised);
    EXPECT_FALSE(placement.T_WC());
  }
  EXPECT_EQ(explorer.map().now(), before);
  EXPECT_EQ(explorer.surface().changes(), surface);
  EXPECT_EQ(explorer.keyframes().all().size(), 2U);
}

TEST(Placement, BeginsAnewWhenATentativePlaceIsNotConfirmed) {
  Explored explored;
  Placement placement(explored.explorer);
  EXPECT_EQ(placement.offer(seenFrom(along(1.2), 100)), PlacementState::kTentative);
  RgbdFrame blind = seenFrom(along(1.2), 101);
  blind.depth_m.setTo(0.0F);
  EXPECT_EQ(placement.offer(blind), PlacementState::kUnlocalised);
  EXPECT_EQ(placement.offer(seenFrom(along(1.2), 102)), PlacementState::kTentative);
  EXPECT_EQ(placement.offer(seenFrom(along(1.2), 103)), PlacementState::kTentative);
}

TEST(Placement, StartsFromAPoseGivenByHandWhereNoFeatureIsKnown) {
  Explored explored;
  Placement placement(explored.explorer, along(1.0));
  // The room was painted anew: features are strange, the surface is not.
  EXPECT_EQ(placement.offer(seenFrom(along(1.2), 100, 2)), PlacementState::kTentative);
  ASSERT_TRUE(placement.T_WC());
  EXPECT_LT(distance(*placement.T_WC(), along(1.2)), kPlaceError_m);
}

}  // namespace
}  // namespace saccade
