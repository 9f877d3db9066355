#include <filesystem>
#include <fstream>
#include <sys/stat.h>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::ProgramRun;
using test::runSaccade;
using test::TemporaryFolder;

/// A failed run says one sentence that names `path`, and nothing like a crash.
void expectOneClearError(const ProgramRun& run, int exit_code, const std::string& part) {
  EXPECT_EQ(run.exit_code, exit_code) << run.talk;
  EXPECT_NE(run.talk.find(part), std::string::npos) << "\"" << part << "\" is missing in: " << run.talk;
  EXPECT_EQ(run.output, "");
}

/// Writes `count` frames of a TUM folder with the given colour and depth images.
void writeTumFolder(const std::filesystem::path& folder, int count, const cv::Mat& color, const cv::Mat& depth) {
  std::filesystem::create_directories(folder / "rgb");
  std::filesystem::create_directories(folder / "depth");
  std::ofstream rgb_list(folder / "rgb.txt"), depth_list(folder / "depth.txt");
  for (int i = 0; i < count; ++i) {
    const std::string name = std::to_string(1000 + i) + ".000000.png";
    cv::imwrite((folder / "rgb" / name).string(), color);
    cv::imwrite((folder / "depth" / name).string(), depth);
    rgb_list << 1000 + i << ".0 rgb/" << name << "\n";
    depth_list << 1000 + i << ".0 depth/" << name << "\n";
  }
  std::ofstream(folder / "camera.txt") << "525 525 319.5 239.5 " << color.cols << " " << color.rows << " 5000\n";
}

const cv::Mat kColor(48, 64, CV_8UC3, cv::Scalar(50, 100, 150));
const cv::Mat kDepth(48, 64, CV_16UC1, cv::Scalar(5000));

TEST(BadInput, UsageErrorsExitWithTwo) {
  EXPECT_EQ(runSaccade({}).exit_code, 2);
  EXPECT_EQ(runSaccade({"explore"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"explore", "sim:desk", "--no-such-option"}).exit_code, 2);
  expectOneClearError(runSaccade({"explore", "sim:desk", "--range", "a:b"}), 2, "a:b");
  expectOneClearError(runSaccade({"explore", "sim:desk", "--set", "map.leaf_size=abc"}), 2, "map.leaf_size");
  EXPECT_EQ(runSaccade({"--help"}).exit_code, 0);
  EXPECT_EQ(runSaccade({"--version"}).exit_code, 0);
}

TEST(BadInput, AMissingFolderAndAnUnknownSceneAreNamed) {
  expectOneClearError(runSaccade({"explore", "no/such/folder"}), 1, "no/such/folder");
  expectOneClearError(runSaccade({"explore", "sim:nowhere"}), 1, "nowhere");
  const TemporaryFolder empty;
  expectOneClearError(runSaccade({"explore", empty.path()}), 1, empty.path());
}

TEST(BadInput, EightBitDepthSwappedImagesAndOtherSizesAreNamed) {
  const TemporaryFolder folder;
  writeTumFolder(folder / "eight-bit", 3, kColor, cv::Mat(48, 64, CV_8UC1, cv::Scalar(100)));
  expectOneClearError(runSaccade({"explore", folder / "eight-bit"}), 1, "16");
  writeTumFolder(folder / "swapped", 3, kDepth, kColor);
  expectOneClearError(runSaccade({"explore", folder / "swapped"}), 1, "swapped");
  writeTumFolder(folder / "sizes", 3, kColor, cv::Mat(24, 32, CV_16UC1, cv::Scalar(5000)));
  expectOneClearError(runSaccade({"explore", folder / "sizes"}), 1, "32");
}

TEST(BadInput, OneTruncatedImageIsSkippedAndCounted) {
  const TemporaryFolder folder;
  writeTumFolder(folder / "tum", 4, kColor, kDepth);
  std::filesystem::resize_file(folder / "tum/depth/1002.000000.png", 60);
  const ProgramRun run = runSaccade({"explore", folder / "tum", "-o", folder / "s.saccade"});
  EXPECT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_NE(run.talk.find("1002.000000.png"), std::string::npos) << run.talk;
  const ProgramRun inspect = runSaccade({"inspect", folder / "s.saccade", "--json"});
  EXPECT_NE(inspect.output.find("\"skipped\": 1"), std::string::npos) << inspect.output;
}

TEST(BadInput, AnEmptyListIsNamed) {
  const TemporaryFolder folder;
  writeTumFolder(folder / "tum", 1, kColor, kDepth);
  std::ofstream(folder / "tum/depth.txt") << "# nothing\n";
  expectOneClearError(runSaccade({"explore", folder / "tum"}), 1, "depth.txt");
}

TEST(BadInput, OutputsThatCannotBeWrittenAreNamedBeforeTheWorkBegins) {
  for (const char* option : {"-o", "--trajectory", "--candidates", "--video"}) {
    expectOneClearError(runSaccade({"explore", "sim:desk", option, "no/such/place/x.out"}), 1, "no/such/place");
  }
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "x";
  expectOneClearError(runSaccade({"explore", "sim:desk", "--frames-dir", folder / "file"}), 1, folder / "file");
}

TEST(BadInput, AFullDiskIsNamed) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  expectOneClearError(runSaccade({"explore", "sim:desk", "--range", ":3", "--candidates", "/dev/full"}), 1,
                      "/dev/full");
}

TEST(BadInput, AConfigFileThatIsMissingOrWrongIsNamed) {
  const TemporaryFolder folder;
  expectOneClearError(runSaccade({"explore", "sim:desk", "--config", "no/such.yaml"}), 1, "no/such.yaml");
  std::ofstream(folder / "bad.yaml") << "map: {leaf_sise: 0.01}\nranking: {top_k: -3}\n";
  const ProgramRun run = runSaccade({"explore", "sim:desk", "--config", folder / "bad.yaml"});
  expectOneClearError(run, 1, "leaf_sise");
  EXPECT_NE(run.talk.find("top_k"), std::string::npos) << run.talk;
}

TEST(BadInput, GivenPosesWithNanOrNoneForAnyFrameAreNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder / "nan.txt") << "0 nan 0 0 0 0 0 1\n";
  expectOneClearError(runSaccade({"explore", "sim:desk", "--poses", folder / "nan.txt"}), 1, "nan.txt");
  expectOneClearError(runSaccade({"explore", "sim:desk", "--poses", folder / "missing.txt"}), 1, "missing.txt");
}

TEST(BadInput, InspectRefusesWhatIsNoSession) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x.saccade") << "not a session";
  expectOneClearError(runSaccade({"inspect", folder / "x.saccade"}), 1, "x.saccade");
  expectOneClearError(runSaccade({"inspect", folder / "none.saccade"}), 1, "none.saccade");
}

}  // namespace
}  // namespace saccade
