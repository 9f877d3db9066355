#include "saccade/simulation/sequence_writer.hpp"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/simulation/simulated_source.hpp"
#include "saccade/sources/label_folder.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::TemporaryFolder;

void writeSequence(const std::filesystem::path& folder, WhenFolderExists when, int frames) {
  SimulationRequest request;
  request.frames = frames;
  SimulatedSource source(request);
  SequenceWriter writer(folder, when, simulatedCamera());
  RgbdFrame frame;
  while (source.read(frame) == ReadStatus::kFrame) writer.write(frame);
  writer.finish(source.objects());
}

TEST(SequenceWriter, WritesWhatTheTumReaderReadsBack) {
  const TemporaryFolder folder;
  writeSequence(folder / "s", WhenFolderExists::kRefuse, 3);
  const auto original = openSource("sim:desk?frames=3"), copy = openSource(folder / "s");
  EXPECT_EQ(copy->description().frames, 3);
  EXPECT_EQ(copy->description().camera, simulatedCamera());
  EXPECT_TRUE(copy->description().has_poses);
  EXPECT_TRUE(copy->description().remarks.empty());
  RgbdFrame a, b;
  LabelFolder labels(folder / "s");
  // Depth is rounded to 1/5000 m, poses to nine digits.
  constexpr double kHalfUnit_m = 0.5 / 5000 + 1e-6, kPose = 1e-7;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(original->read(a), ReadStatus::kFrame);
    ASSERT_EQ(copy->read(b), ReadStatus::kFrame);
    EXPECT_EQ(a.name, b.name);
    EXPECT_NEAR(a.stamp_s, b.stamp_s, 1e-6);
    EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0.0);
    EXPECT_LE(cv::norm(a.depth_m, b.depth_m, cv::NORM_INF), kHalfUnit_m);
    EXPECT_TRUE(a.T_WC->isApprox(*b.T_WC, kPose));
    const auto label = labels.load(b.name);
    ASSERT_TRUE(label);
    EXPECT_EQ(cv::norm(a.label, *label, cv::NORM_INF), 0.0);
  }
}

TEST(SequenceWriter, ListsEveryObject) {
  const TemporaryFolder folder;
  writeSequence(folder / "s", WhenFolderExists::kRefuse, 1);
  std::ifstream file(folder / "s" / "objects.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "id,kind,frames,most_pixels");
  int rows = 0;
  while (std::getline(file, line)) EXPECT_EQ(std::stoi(line), ++rows);
  EXPECT_EQ(rows, 12);
}

TEST(SequenceWriter, ReplacesASequenceOnlyIfTold) {
  const TemporaryFolder folder;
  writeSequence(folder / "s", WhenFolderExists::kRefuse, 2);
  std::ofstream(folder / "s" / "notes.txt") << "mine\n";
  EXPECT_THROW(writeSequence(folder / "s", WhenFolderExists::kRefuse, 1), IoError);
  writeSequence(folder / "s", WhenFolderExists::kReplace, 1);
  EXPECT_EQ(openSource(folder / "s")->description().frames, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "s" / "rgb" / "desk-000001.png")) << "left from the sequence before";
  EXPECT_TRUE(std::filesystem::exists(folder / "s" / "notes.txt")) << "not ours to remove";
}

TEST(SequenceWriter, SaysWhatItCannotWriteTo) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "no folder\n";
  for (const auto when : {WhenFolderExists::kRefuse, WhenFolderExists::kReplace}) {
    EXPECT_THROW(SequenceWriter(folder / "file", when, simulatedCamera()), IoError);
    EXPECT_THROW(SequenceWriter(folder / "file" / "below", when, simulatedCamera()), IoError);
  }
  EXPECT_THROW(SequenceWriter("/proc/no_such", WhenFolderExists::kRefuse, simulatedCamera()), IoError);
}

TEST(SequenceWriter, NoticesAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TemporaryFolder folder;
  SimulatedSource source(SimulationRequest{});
  SequenceWriter writer(folder / "s", WhenFolderExists::kRefuse, simulatedCamera());
  RgbdFrame frame;
  ASSERT_EQ(source.read(frame), ReadStatus::kFrame);
  std::filesystem::create_symlink("/dev/full", folder / "s" / "depth" / (frame.name + ".png"));
  EXPECT_THROW(writer.write(frame), IoError);
}

}  // namespace
}  // namespace saccade
