#include "reporting/report_views.hpp"

#include <gtest/gtest.h>

#include "saccade/map/ior_octree.hpp"

namespace saccade {
namespace {

const PinholeCamera kCamera{64, 48, 60.0, 60.0, 31.5, 23.5};

ReportView viewWithWallAt(float depth_m) {
  ReportView view;
  view.color = cv::Mat3b(48, 64, cv::Vec3b(0, 0, 0));
  view.depth_m = cv::Mat1f(48, 64, depth_m);
  return view;
}

TEST(EvenlyChosen, SpreadsOverAllAndNeverTakesMoreThanThereAre) {
  EXPECT_EQ(evenlyChosen(10, 3), (std::vector<std::size_t>{0, 3, 6}));
  EXPECT_EQ(evenlyChosen(2, 5), (std::vector<std::size_t>{0, 1}));
  EXPECT_TRUE(evenlyChosen(0, 5).empty());
}

TEST(ProjectedLeaves, LieWhereTheCameraSeesThemAndNotBehindWhatItMeasured) {
  const IorMap map;  // leaves of 1 cm
  const LeafKey ahead = *map.keyAt({0.005, 0.005, 1.0}), behind = *map.keyAt({0.005, 0.005, -1.0}),
                aside = *map.keyAt({5.0, 0.005, 1.0});
  const std::vector<LeafKey> leaves = {ahead, behind, aside};
  cv::Mat1b mask(48, 64, static_cast<std::uint8_t>(0));
  const ProjectedLeaves seen = projectLeaves(leaves, map, kCamera, viewWithWallAt(1.0f), &mask);
  EXPECT_EQ(seen.visible, 1u);
  EXPECT_TRUE(seen.box.contains(cv::Point(32, 24)));
  EXPECT_LE(seen.box.width, 3);
  EXPECT_EQ(mask(24, 32), 255);
  EXPECT_EQ(cv::countNonZero(mask), seen.box.area());
  EXPECT_EQ(projectLeaves(leaves, map, kCamera, viewWithWallAt(0.9f)).visible, 0u) << "a wall stands before it";
  EXPECT_EQ(projectLeaves(leaves, map, kCamera, viewWithWallAt(0.0f)).visible, 1u) << "nothing was measured";
}

TEST(DrawLooks, TintsAndBoxesWhatTheFramesTickAttendedAndNothingInOtherFrames) {
  const IorMap map;
  std::vector<LeafKey> leaves;
  for (int i = 0; i < 20; ++i) leaves.push_back(*map.keyAt({0.005 + 0.01 * i, 0.005, 1.0}));
  AttendLog log;
  const CandidateLeaves candidate{0, leaves};
  log.record({Tick{4}, FrameIndex{4}, {}, {}}, {&candidate, 1});
  ReportView view = viewWithWallAt(1.0f);
  view.frame.tick = 5;
  EXPECT_GT(cv::countNonZero(drawLooks(view, log, map, kCamera).reshape(1)), 20);
  view.frame.tick = 4;
  EXPECT_EQ(cv::countNonZero(drawLooks(view, log, map, kCamera).reshape(1)), 0);
}

}  // namespace
}  // namespace saccade
