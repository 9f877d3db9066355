#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::ProgramRun;
using test::runSaccade;
using test::TemporaryFolder;

const std::string kSession = std::string(SACCADE_SOURCE_DIR) + "/maps/coffee.saccade";

/// Share of the pixels that differ from the picture's first one: what is not background.
double coveredShare(const cv::Mat3b& picture) {
  int covered = 0;
  for (const cv::Vec3b& pixel : picture) covered += pixel != picture(0, 0) ? 1 : 0;
  return static_cast<double>(covered) / static_cast<double>(picture.total());
}

TEST(RenderCommand, DrawsTheWholeMapWithoutADisplay) {
  const TemporaryFolder folder;
  const ProgramRun run = runSaccade({"render", kSession, "-o", folder / "all.png", "--size", "320x240"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const cv::Mat3b picture = cv::imread((folder / "all.png").string());
  ASSERT_EQ(picture.size(), cv::Size(320, 240));
  EXPECT_GT(coveredShare(picture), 0.1);
  EXPECT_LT(coveredShare(picture), 0.9);
}

TEST(RenderCommand, AFramesPoseGivesThePictureOfTheSessionsCamera) {
  const TemporaryFolder folder;
  for (const char* layer : {"color", "flag", "weight", "depth", "normal", "height", "occupancy"}) {
    const std::string path = folder / (std::string(layer) + ".png");
    const ProgramRun run = runSaccade({"render", kSession, "-o", path, "--frame", "8", "--layer", layer});
    ASSERT_EQ(run.exit_code, 0) << run.talk;
    EXPECT_EQ(cv::imread(path).size(), cv::Size(640, 480)) << layer;
  }
  const ProgramRun missing = runSaccade({"render", kSession, "-o", folder / "no.png", "--frame", "7"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.talk.find("a frame 7"), std::string::npos) << missing.talk;
}

TEST(RenderCommand, ATurntableIsAVideoOfTheAskedLength) {
  const TemporaryFolder folder;
  const std::string path = folder / "turn.mp4";
  const ProgramRun run =
      runSaccade({"render", kSession, "-o", path, "--turntable", "--frames", "6", "--size", "160x120"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  cv::VideoCapture video(path);
  int pictures = 0;
  for (cv::Mat3b picture; video.read(picture); ++pictures) ASSERT_EQ(picture.size(), cv::Size(160, 120));
  EXPECT_EQ(pictures, 6);
}

TEST(RenderCommand, NothingIsOverwrittenAndMistakesAreUsageErrors) {
  const TemporaryFolder folder;
  const std::string path = folder / "p.png";
  ASSERT_EQ(runSaccade({"render", kSession, "-o", path, "--size", "32x24"}).exit_code, 0);
  EXPECT_EQ(runSaccade({"render", kSession, "-o", path, "--size", "32x24"}).exit_code, 1);
  EXPECT_EQ(runSaccade({"render", kSession, "-o", path, "--size", "32x24", "--force"}).exit_code, 0);
  EXPECT_EQ(runSaccade({"render", kSession, "-o", folder / "q.png", "--turntable"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"render", kSession, "-o", folder / "q.png", "--pose", "1 2"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"render", kSession, "-o", folder / "q.png", "--layer", "heat"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"render", kSession, "-o", folder / "q.png", "--size", "0x9"}).exit_code, 2);
}

}  // namespace
}  // namespace saccade
