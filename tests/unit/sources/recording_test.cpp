#include "saccade/sources/recording.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "support/tiny_folders.hpp"

namespace saccade {
namespace {

using test::TinyFolder;

// A sensor whose depth is not registered, with distorted lenses, odd stamps and poses; OpenNI2 wants images of 4n.
const char* const kCameraYaml =
    "color: {width: 64, height: 48, fx: 70.25, fy: 71, cx: 31, cy: 23.5, distortion: [0.1, -0.02, 0.001, 0.002, "
    "0.003]}\n"
    "depth: {width: 32, height: 24, fx: 35, fy: 36, cx: 15.5, cy: 12, units_per_metre: 1000}\n"
    "T_color_depth: [[1,0,0,0.025],[0,1,0,0.001],[0,0,1,-0.002],[0,0,0,1]]\n"
    "images: {color: c, depth: d, frames_per_second: 29.97, poses: poses.txt}\n";
constexpr int kFrames = 4;

void writeSensor(const TinyFolder& folder, const std::string& yaml = kCameraYaml) {
  std::string poses;
  for (int i = 0; i < kFrames; ++i) {
    const std::string number = std::to_string(i);
    folder.write("c/" + number + ".png", test::tinyColor(17 * i, 64, 48));
    folder.write("d/" + number + ".png", test::tinyDepth(900 + 300 * i));
    poses += std::to_string(i / 29.97) + " " + number + " 0.5 0 0 0.6 0 0.8\n";
  }
  folder.write("camera.yaml", yaml);
  folder.write("poses.txt", poses);
}

struct Kind {
  const char* output;
  const char* layout;
  double stamp_rounding_s;
  bool keeps_poses;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.output << " " << kind.layout;
}

/// Records `input`; skips the test where this build lacks the library or OpenNI2 the virtual camera.
std::vector<std::string> record(const std::filesystem::path& input, const std::filesystem::path& output,
                                const std::string& layout) {
  const auto source = openSensorSource(input.string());
  const auto writer = openRecording(output, recordingKindOf(output, layout), *source, WhenRecordingExists::kRefuse);
  SensorFrame frame;
  while (source->read(frame) == ReadStatus::kFrame) writer->write(frame);
  writer->finish();
  return writer->losses();
}

bool sameMeasurements(const cv::Mat1w& a, const SensorFrame& b, double units_per_metre) {
  const cv::Size size = b.raw_depth.empty() ? b.depth_m.size() : b.raw_depth.size();
  if (a.size() != size) return false;
  for (int v = 0; v < a.rows; ++v) {
    for (int u = 0; u < a.cols; ++u) {
      const int raw = a(v, u) == 65535 ? 0 : a(v, u);
      const int other =
          b.raw_depth.empty()
              ? (b.depth_m(v, u) > 0 ? static_cast<int>(std::lround(b.depth_m(v, u) * units_per_metre)) : 0)
              : (b.raw_depth(v, u) == 65535 ? 0 : b.raw_depth(v, u));
      if (raw != other) return false;
    }
  }
  return true;
}

class Recordings : public ::testing::TestWithParam<Kind> {};

TEST_P(Recordings, GiveBackTheSameImagesStampsPosesAndCalibration) {
  const TinyFolder folder;
  writeSensor(folder);
  const TinyFolder place;
  const std::filesystem::path output = place / GetParam().output;
  try {
    record(folder.path(), output, GetParam().layout);
  } catch (const IoError& error) {
    if (error.found() == "one built without") GTEST_SKIP() << error.what();
    throw;
  }
  const auto original = openSensorSource(folder.path().string()), again = openSensorSource(output.string());
  constexpr double kMatrixRounding = 1e-12;  // rotations are stored as angles or quaternions
  EXPECT_EQ(again->calibration().color, original->calibration().color);
  EXPECT_EQ(again->calibration().color_distortion.p2, original->calibration().color_distortion.p2);
  ASSERT_TRUE(again->calibration().depth);
  EXPECT_EQ(again->calibration().depth->camera, original->calibration().depth->camera);
  EXPECT_TRUE(again->calibration().depth->T_CD.isApprox(original->calibration().depth->T_CD, kMatrixRounding));
  EXPECT_EQ(again->calibration().depth_units_per_metre, 1000.0);
  SensorFrame first, second;
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_EQ(original->read(first), ReadStatus::kFrame);
    ASSERT_EQ(again->read(second), ReadStatus::kFrame) << i << ": " << again->progress().end_reason;
    EXPECT_EQ(cv::norm(first.color, second.color, cv::NORM_INF), 0.0) << i;
    EXPECT_TRUE(sameMeasurements(first.raw_depth, second, 1000.0)) << i;
    EXPECT_NEAR(first.stamp_s, second.stamp_s, GetParam().stamp_rounding_s) << i;
    EXPECT_EQ(second.T_WC.has_value(), GetParam().keeps_poses);
    if (second.T_WC) {
      EXPECT_TRUE(second.T_WC->isApprox(*first.T_WC, kMatrixRounding)) << i;
    }
  }
  EXPECT_EQ(again->read(second), ReadStatus::kEnd);
  EXPECT_EQ(again->progress().end_reason, "");
}

TEST_P(Recordings, KeepTheRangeThatIsAskedFor) {
  const TinyFolder folder;
  writeSensor(folder);
  const TinyFolder place;
  const std::filesystem::path output = place / GetParam().output;
  try {
    record(folder.path(), output, GetParam().layout);
  } catch (const IoError& error) {
    if (error.found() == "one built without") GTEST_SKIP() << error.what();
    throw;
  }
  const auto source = openSensorSource(output.string(), FrameRange::parse("1:4:2"));
  SensorFrame frame;
  ASSERT_EQ(source->read(frame), ReadStatus::kFrame);
  EXPECT_EQ(frame.index, FrameIndex{1});
  EXPECT_EQ(cv::norm(frame.color, test::tinyColor(17, 64, 48), cv::NORM_INF), 0.0);
  ASSERT_EQ(source->read(frame), ReadStatus::kFrame);
  EXPECT_EQ(frame.index, FrameIndex{3});
  EXPECT_EQ(source->read(frame), ReadStatus::kEnd);
}

TEST_P(Recordings, AreNotReplacedUnasked) {
  const TinyFolder folder;
  writeSensor(folder);
  const TinyFolder place;
  const std::filesystem::path output = place / GetParam().output;
  try {
    record(folder.path(), output, GetParam().layout);
  } catch (const IoError& error) {
    if (error.found() == "one built without") GTEST_SKIP() << error.what();
    throw;
  }
  EXPECT_THROW(record(folder.path(), output, GetParam().layout), IoError);
}

// Stamps: exact, exact, 100 ns, 1 ns, 1 us; half a unit and the rounding of doubles.
INSTANTIATE_TEST_SUITE_P(Kinds, Recordings,
                         ::testing::Values(Kind{"folder", "tum", 0.0, true}, Kind{"folder", "7scenes", 0.0, true},
                                           Kind{"a.rawlog", "tum", 0.51e-7, true}, Kind{"a.bag", "tum", 0.51e-9, true},
                                           Kind{"a.oni", "tum", 0.51e-6, false}));

/// The ideal frames of an input: all that exploring it depends on.
std::vector<RgbdFrame> framesOf(const std::filesystem::path& input) {
  const auto source = openSource(input.string());
  std::vector<RgbdFrame> frames(1);
  while (source->read(frames.back()) == ReadStatus::kFrame) frames.emplace_back();
  frames.pop_back();
  return frames;
}

void expectSameFrames(const std::vector<RgbdFrame>& expected, const std::vector<RgbdFrame>& found,
                      const std::string& where) {
  ASSERT_EQ(expected.size(), found.size()) << where;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(expected[i].stamp_s, found[i].stamp_s) << where << ", frame " << i;
    EXPECT_EQ(cv::norm(expected[i].color, found[i].color, cv::NORM_INF), 0.0) << where << ", frame " << i;
    EXPECT_EQ(cv::norm(expected[i].depth_m, found[i].depth_m, cv::NORM_INF), 0.0) << where << ", frame " << i;
  }
}

// Bit for bit, not nearly: a prediction of the motion that differs in the last bit grows into another candidate.
TEST(Recording, AChainThroughEveryContainerGivesTheVerySameFrames) {
  for (const char* units : {"1000", "5000", "10000"}) {
    const TinyFolder folder, place;
    folder.write("camera.yaml",
                 "color: {width: 64, height: 48, fx: 70.25, fy: 71, cx: 31, cy: 23.5}\n"
                 "depth: {width: 32, height: 24, fx: 35, fy: 36, cx: 15.5, cy: 12, invalid: [0, 1500], "
                 "units_per_metre: " +
                     std::string(units) +
                     "}\n"
                     "T_color_depth: [[1,0,0,0.025],[0,1,0,0.001],[0,0,1,-0.002],[0,0,0,1]]\n");
    std::string rgb, depth;
    for (int i = 0; i < kFrames; ++i) {
      // Stamps since 1970 with more digits than any container keeps, of which colour and depth have different ones.
      const std::string number = std::to_string(i);
      rgb += "1305031102.1" + number + "5304567 rgb/" + number + ".png\n";
      depth += "1305031102.1" + number + "6304561 depth/" + number + ".png\n";
      folder.write("rgb/" + number + ".png", test::tinyColor(17 * i, 64, 48));
      folder.write("depth/" + number + ".png", test::tinyDepth(1400 + 300 * i));
    }
    folder.write("rgb.txt", rgb);
    folder.write("depth.txt", depth);
    const std::vector<RgbdFrame> expected = framesOf(folder.path());
    ASSERT_EQ(expected.size(), static_cast<std::size_t>(kFrames));
    std::filesystem::path last = folder.path();
    for (const char* name : {"tum", "a.oni", "a.rawlog", "a.bag", "7scenes"}) {
      try {
        EXPECT_EQ(record(last, place / name, name == std::string("7scenes") ? "7scenes" : "tum"),
                  std::vector<std::string>{})
            << name << " is not lossless, units " << units;
      } catch (const IoError& error) {
        if (error.found() == "one built without") continue;
        throw;
      }
      last = place / name;
      expectSameFrames(expected, framesOf(last), std::string(name) + ", units " + units);
    }
  }
}

TEST(Recording, AnOniFileThatCannotKeepTheLastPixelOfDepthChangesThatOneOnlyAndSaysSo) {
  const TinyFolder folder, place;
  writeSensor(folder);
  cv::Mat1w depth = test::tinyDepth(900);
  depth.row(depth.rows - 1).setTo(2000);
  depth(depth.rows - 1, depth.cols - 1) = 1999;
  folder.write("d/0.png", depth);
  std::vector<std::string> losses;
  try {
    losses = record(folder.path(), place / "a.oni", "tum");
  } catch (const IoError& error) {
    if (error.found() == "one built without") GTEST_SKIP() << error.what();
    throw;
  }
  ASSERT_FALSE(losses.empty());
  EXPECT_NE(losses.front().find("the last pixel of depth in 1 frames"), std::string::npos) << losses.front();
  SensorFrame frame;
  ASSERT_EQ(openSensorSource((place / "a.oni").string())->read(frame), ReadStatus::kFrame);
  depth(depth.rows - 1, depth.cols - 1) = 2000;
  EXPECT_TRUE(sameMeasurements(depth, frame, 1000.0));
}

TEST(Recording, ARawlogKeepsEveryUnitOfDepthInUse) {
  for (const char* units : {"1000", "5000", "6553.5", "10000", "256"}) {
    const TinyFolder folder, place;
    std::string yaml = kCameraYaml;
    yaml.replace(yaml.find("units_per_metre: 1000"), 21, std::string("units_per_metre: ") + units);
    writeSensor(folder, yaml);
    try {
      record(folder.path(), place / "a.rawlog", "tum");
    } catch (const IoError& error) {
      if (error.found() == "one built without") GTEST_SKIP() << error.what();
      throw;
    }
    EXPECT_DOUBLE_EQ(openSensorSource((place / "a.rawlog").string())->calibration().depth_units_per_metre,
                     std::stod(units));
  }
}

TEST(Recording, CutOffFilesGiveTheFramesBeforeTheCutAndSaySo) {
  const TinyFolder folder;
  writeSensor(folder);
  for (const char* name : {"a.rawlog", "a.bag", "a.oni"}) {
    const TinyFolder place;
    try {
      record(folder.path(), place / name, "tum");
    } catch (const IoError& error) {
      if (error.found() == "one built without") continue;
      throw;
    }
    place.truncate(name, 0.6);
    std::string told;
    int frames = 0;
    try {
      const auto source = openSensorSource((place / name).string());
      SensorFrame frame;
      while (source->read(frame) == ReadStatus::kFrame) ++frames;
      told = source->progress().end_reason;
    } catch (const IoError& error) {
      told = error.what();
    }
    EXPECT_LT(frames, kFrames) << name;
    EXPECT_NE(told.find(name), std::string::npos) << "silence about " << name;
  }
}

TEST(Recording, ForeignFilesAreNamed) {
  const TinyFolder folder;
  for (const char* name : {"a.rawlog", "a.bag", "a.oni", "a.mp4"}) {
    for (const std::string& content : {std::string(), std::string("no recording at all, just some text")}) {
      folder.write(name, content);
      try {
        (void)openSensorSource((folder / name).string());
        ADD_FAILURE() << name << " was opened";
      } catch (const IoError& error) {
        EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      }
    }
  }
}

TEST(Recording, DepthInMetresIsKeptByBagsAndRoundedElsewhereAndSaidToBe) {
  const TinyFolder place;
  EXPECT_EQ(record("sim:plain?frames=2", place / "folder", "tum"),
            std::vector<std::string>{"depth in metres was rounded to 1/5000 m"});
  const auto exact = openSource("sim:plain?frames=2"), rounded = openSource((place / "folder").string());
  RgbdFrame a, b;
  ASSERT_EQ(exact->read(a), ReadStatus::kFrame);
  ASSERT_EQ(rounded->read(b), ReadStatus::kFrame);
  constexpr double kHalfAUnit_m = 0.5 / 5000.0 + 1e-6;
  EXPECT_LE(cv::norm(a.depth_m, b.depth_m, cv::NORM_INF), kHalfAUnit_m);
  EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0.0);
}

TEST(Recording, FullDiskIsAnErrorAndLeavesNoFileOfThatName) {
  // /dev/full takes nothing; a partial file that is a link to it stands for a full disk.
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const TinyFolder folder;
  writeSensor(folder);
  for (const char* name : {"a.rawlog", "a.bag"}) {
    const TinyFolder place;
    std::filesystem::create_symlink("/dev/full", place / (std::string(name) + ".partial"));
    EXPECT_THROW(record(folder.path(), place / name, "tum"), IoError) << name;
    EXPECT_FALSE(std::filesystem::exists(place / name)) << name;
  }
  const TinyFolder place;
  std::filesystem::create_directories(place / "out/rgb");
  std::filesystem::create_symlink("/dev/full", place / "out/rgb/2.png");
  const auto source = openSensorSource(folder.path().string());
  const auto writer = openRecording(place / "out", RecordingKind::kTumFolder, *source, WhenRecordingExists::kReplace);
  std::filesystem::create_symlink("/dev/full", place / "out/rgb/2.png");
  SensorFrame frame;
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(source->read(frame), ReadStatus::kFrame);
    writer->write(frame);
  }
  ASSERT_EQ(source->read(frame), ReadStatus::kFrame);
  EXPECT_THROW(writer->write(frame), IoError);
  EXPECT_EQ(openSource((place / "out").string())->description().frames, 2) << "the frames before are a whole recording";
}

}  // namespace
}  // namespace saccade
