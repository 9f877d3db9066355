#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/sources/recording.hpp"
#include "support/tiny_folders.hpp"
#if SACCADE_WITH_OPENNI2
#include "sources/openni2_library.hpp"
#include "virtual_camera/virtual_camera_protocol.hpp"
#endif

namespace saccade {
namespace {

using test::TinyFolder;

/// A TUM folder with depth in tenths of a millimetre, which OpenNI2 keeps as it is.
void writeFrames(const TinyFolder& folder, int frames) {
  std::string rgb, depth;
  for (int i = 0; i < frames; ++i) {
    const std::string stamp = std::to_string(100.0 + i / 30.0), file = std::to_string(i) + ".png";
    rgb += stamp + " rgb/" + file + "\n";
    depth += stamp + " depth/" + file + "\n";
    folder.write("rgb/" + file, test::tinyColor(i, 64, 48));
    folder.write("depth/" + file, test::tinyDepth(10000 + i, 64, 48));
  }
  folder.write("rgb.txt", rgb);
  folder.write("depth.txt", depth);
  folder.write("camera.txt", std::string("80 82 32 24 64 48 10000\n"));
}

class OpenNi2Camera : public ::testing::Test {
 protected:
  void SetUp() override {
#if !SACCADE_WITH_OPENNI2
    GTEST_SKIP() << "this build lacks OpenNI2";
#endif
  }
};

TEST_F(OpenNi2Camera, PlaysAnInputAsADeviceWithItsFullCalibration) {
  const TinyFolder folder;
  constexpr int kFrames = 6;
  writeFrames(folder, kFrames);
  const auto camera = openSensorSource("openni2:saccade:" + folder.path().string());
  EXPECT_EQ(camera->description().kind, "OpenNI2 camera");
  EXPECT_TRUE(camera->description().is_live);
  EXPECT_EQ(camera->description().frames, -1);
  EXPECT_EQ(camera->description().intrinsics_origin, "the camera's driver");
  EXPECT_EQ(camera->calibration().color, (PinholeCamera{64, 48, 80, 82, 32, 24}));
  EXPECT_EQ(camera->calibration().depth_units_per_metre, 10000.0);
  SensorFrame frame;
  std::int64_t frames = 0;
  while (frames + camera->progress().dropped < kFrames && camera->read(frame) == ReadStatus::kFrame) {
    const int sent = static_cast<int>(std::lround((frame.stamp_s - 100.0) * 30.0));
    EXPECT_EQ(cv::norm(frame.color, test::tinyColor(sent, 64, 48), cv::NORM_INF), 0.0) << sent;
    EXPECT_EQ(frame.raw_depth(7, 9), 10000 + sent + 18 + 7);
    EXPECT_EQ(frame.raw_depth(0, 1), 0) << "no measurement is 0 in OpenNI2";
    ++frames;
  }
  EXPECT_GT(frames, 0);
  EXPECT_EQ(frames + camera->progress().dropped, kFrames);
}

TEST_F(OpenNi2Camera, GoesOnWhereItWasWhenItIsPluggedInAgain) {
  const TinyFolder folder;
  constexpr int kFrames = 12;
  writeFrames(folder, kFrames);
  const auto camera =
      openSensorSource("openni2:saccade:" + folder.path().string() + "#unplug_after=5&replug_after=0.3");
  SensorFrame frame;
  std::int64_t frames = 0;
  bool told = false, came_back = false;
  while (frames + camera->progress().dropped < kFrames) {
    const ReadStatus status = camera->read(frame);
    ASSERT_NE(status, ReadStatus::kEnd) << camera->progress().end_reason;
    if (status == ReadStatus::kFrame) ++frames;
    if (status == ReadStatus::kSkip) told |= camera->skipReason().find("was unplugged") != std::string::npos;
    if (status == ReadStatus::kSkip) came_back |= camera->skipReason().find("is back") != std::string::npos;
  }
  EXPECT_TRUE(told);
  EXPECT_TRUE(came_back);
  EXPECT_NEAR(frame.stamp_s, 100.0 + (kFrames - 1) / 30.0, 1e-5) << "the last frame of the input";
}

TEST_F(OpenNi2Camera, CountsWhatASlowReaderMisses) {
  const TinyFolder folder;
  constexpr int kFrames = 40;
  writeFrames(folder, kFrames);
  const auto camera = openSensorSource("openni2:saccade:" + folder.path().string() + "#speed=20");
  SensorFrame frame;
  std::int64_t frames = 0;
  while (frames + camera->progress().dropped < kFrames) {
    if (camera->read(frame) == ReadStatus::kFrame) ++frames;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_GT(camera->progress().dropped, 0);
  EXPECT_EQ(frames + camera->progress().dropped, kFrames);
}

TEST_F(OpenNi2Camera, NamesACameraThatIsNotThereAndAnInputThatIsBad) {
  for (const char* uri : {"openni2:no-such-device", "openni2:saccade:/no/such/folder",
                          "openni2:saccade:sim:desk#speed=0", "openni2:saccade:sim:desk#what=1"}) {
    try {
      (void)openSensorSource(uri);
      ADD_FAILURE() << uri << " was opened";
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find(uri), std::string::npos) << error.what();
    }
  }
}

TEST_F(OpenNi2Camera, SlowEndsWithAReasonWhenTheCameraStaysAway) {
  const TinyFolder folder;
  writeFrames(folder, 3);
  const auto camera = openSensorSource("openni2:saccade:" + folder.path().string());
  SensorFrame frame;
  ReadStatus status = ReadStatus::kFrame;
  while (status != ReadStatus::kEnd) status = camera->read(frame);
  EXPECT_NE(camera->progress().end_reason.find("did not come back"), std::string::npos);
}

#if SACCADE_WITH_OPENNI2
// A mark while the recorder's thread takes note of the streams would lock both up for good.
TEST_F(OpenNi2Camera, RefusesAMarkUntilARecorderHasTakenNoteOfItsStreams) {
  const OpenNi2Library library("the test");
  OpenNi2Streams streams;
  streams.open("saccade:push#color=64x48&depth=64x48&color_focal=80x80&depth_focal=80x80&unit=mm", "the test");
  std::string mark = "some bytes";
  EXPECT_EQ(streams.device.invoke(virtual_camera::kMarkCommand, mark.data(), static_cast<int>(mark.size())),
            openni::STATUS_OUT_OF_FLOW);
}
#endif

TEST_F(OpenNi2Camera, RecordingsWorkWithoutTheSideFileToo) {
  const TinyFolder folder, place;
  writeFrames(folder, 3);
  const auto source = openSensorSource(folder.path().string());
  const auto writer = openRecording(place / "a.oni", RecordingKind::kOni, *source, WhenRecordingExists::kRefuse);
  SensorFrame frame;
  while (source->read(frame) == ReadStatus::kFrame) writer->write(frame);
  writer->finish();
  EXPECT_EQ(openSensorSource((place / "a.oni").string())->calibration().origin, "a.oni.yaml");
  std::filesystem::remove(place / "a.oni.yaml");
  const auto bare = openSensorSource((place / "a.oni").string());
  EXPECT_EQ(bare->calibration().origin, "the field of view");
  constexpr double kFieldOfViewRounding_px = 1e-3;  // kept as a float in radians
  EXPECT_NEAR(bare->calibration().color.fx, 80.0, kFieldOfViewRounding_px);
  EXPECT_NEAR(bare->calibration().color.fy, 82.0, kFieldOfViewRounding_px);
  EXPECT_EQ(bare->calibration().depth_units_per_metre, 10000.0);
}

}  // namespace
}  // namespace saccade
