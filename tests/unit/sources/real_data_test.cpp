#include <filesystem>

#include <gtest/gtest.h>

#include "saccade/sources/frame_source.hpp"

namespace saccade {
namespace {

struct RealInput {
  const char* folder;
  const char* kind;
  std::int64_t frames;
  double fx;
  double depth_units_per_metre;
  bool registered, poses, labels;
};

void PrintTo(const RealInput& input, std::ostream* out) {
  *out << input.folder;
}

class RealData : public ::testing::TestWithParam<RealInput> {};

TEST_P(RealData, IsUnderstoodAndItsFirstFramesRead) {
  const RealInput& expected = GetParam();
  const std::filesystem::path folder = std::filesystem::path(SACCADE_TEST_DATA_DIR) / expected.folder;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const auto source = openSource(folder.string());
  const SourceDescription& description = source->description();
  EXPECT_EQ(description.kind, expected.kind);
  EXPECT_EQ(description.frames, expected.frames);
  EXPECT_EQ(description.dropped, 0);
  EXPECT_EQ(description.color_camera.camera.fx, expected.fx);
  EXPECT_EQ(description.camera.width, 640);
  EXPECT_EQ(description.depth_units_per_metre, expected.depth_units_per_metre);
  EXPECT_EQ(description.depth_was_registered, expected.registered);
  EXPECT_EQ(description.has_poses, expected.poses);
  EXPECT_EQ(description.has_labels, expected.labels);
  RgbdFrame frame;
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(source->read(frame), ReadStatus::kFrame) << source->skipReason();
    EXPECT_EQ(frame.color.size(), cv::Size(640, 480));
    EXPECT_EQ(frame.depth_m.size(), cv::Size(640, 480));
    EXPECT_EQ(frame.T_WC.has_value(), expected.poses);
    EXPECT_GT(cv::countNonZero(frame.depth_m), 640 * 480 / 10);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Folders, RealData,
    ::testing::Values(RealInput{"kitchen", "7-Scenes folder", 500, 521.03, 1000, false, true, false},
                      RealInput{"tum_fr1_rpy", "TUM folder", 279, 517.3, 5000, true, true, false},
                      RealInput{"mosd/learn", "labelled frames", 45, 525, 1000, true, false, true},
                      RealInput{"mosd/test", "labelled frames", 33, 525, 1000, true, false, true},
                      RealInput{"ycbv/0049", "labelled frames", 20, 1066.78, 10000, true, true, true},
                      RealInput{"apc/shelf4", "labelled frames", 15, 615.195, 10000, true, true, true}));

TEST(RealKitchen, HasLabelsFromAnotherFolder) {
  const std::filesystem::path data = SACCADE_TEST_DATA_DIR;
  if (!std::filesystem::exists(data / "kitchen_objects")) GTEST_SKIP() << "no " << data / "kitchen_objects";
  const auto source = openSource((data / "kitchen").string(), FrameRange::parse("0::30"), data / "kitchen_objects");
  EXPECT_EQ(source->description().ignore_from, 100);
  RgbdFrame frame;
  int labelled = 0;
  while (source->read(frame) == ReadStatus::kFrame) labelled += frame.label.empty() ? 0 : 1;
  EXPECT_EQ(labelled, 17);
}

}  // namespace
}  // namespace saccade
