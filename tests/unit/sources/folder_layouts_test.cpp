#include <cmath>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/label_folder.hpp"
#include "support/tiny_folders.hpp"

namespace saccade {
namespace {

using test::tinyColor;
using test::tinyDepth;
using test::TinyFolder;

// One unit of float rounding at the depths used here.
constexpr float kDepthRounding_m = 1e-6f;

std::vector<RgbdFrame> readAll(FrameSource& source) {
  std::vector<RgbdFrame> frames;
  RgbdFrame frame;
  while (source.read(frame) == ReadStatus::kFrame) {
    RgbdFrame copy = frame;
    copy.color = frame.color.clone();
    copy.depth_m = frame.depth_m.clone();
    copy.label = frame.label.clone();
    frames.push_back(copy);
  }
  return frames;
}

TEST(SevenScenesFolder, GivesFramesWithStampsFromTheirNumbersAndDepthInMetres) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  const auto source = openSource(folder.path().string());
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[1].name, "frame-000011");
  EXPECT_EQ(frames[1].index, FrameIndex{1});
  EXPECT_EQ(frames[1].stamp_s, 0.366667) << "11 / 30 s in whole microseconds";
  EXPECT_EQ(cv::norm(frames[1].color, tinyColor(1), cv::NORM_INF), 0.0);
  EXPECT_NEAR(frames[1].depth_m(5, 6), 1e-3f * (1100 + 12 + 5), kDepthRounding_m);
  EXPECT_EQ(frames[1].depth_m(0, 0), 0.0f);
  EXPECT_EQ(frames[1].depth_m(0, 1), 0.0f) << "65535 is no measurement";
  ASSERT_TRUE(frames[1].T_WC);
  EXPECT_EQ(frames[1].T_WC->translation(), Eigen::Vector3d(1, 0.5, -2));
  EXPECT_TRUE(frames[1].label.empty());
}

TEST(SevenScenesFolder, DescribesWhatItUnderstood) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  folder.write("frame-000020.color.png", tinyColor());
  folder.write("frame-000011.pose.txt", std::string("nan 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"));
  const auto source = openSource(folder.path().string());
  const SourceDescription& description = source->description();
  EXPECT_EQ(description.kind, "7-Scenes folder");
  EXPECT_EQ(description.frames, 3);
  EXPECT_EQ(description.dropped, 1);
  EXPECT_EQ(description.camera, (PinholeCamera{32, 24, 40, 41, 16, 12}));
  EXPECT_EQ(description.intrinsics_origin, "camera-intrinsics.txt");
  EXPECT_EQ(description.depth_units_per_metre, 1000.0);
  EXPECT_TRUE(description.depth_was_registered);
  EXPECT_TRUE(description.has_poses);
  EXPECT_FALSE(description.has_labels);
  ASSERT_EQ(description.remarks.size(), 2u);
  EXPECT_NE(description.remarks[0].find("no camera.yaml"), std::string::npos);
  EXPECT_NE(description.remarks[1].find("1 frame without a usable pose"), std::string::npos);
  EXPECT_FALSE(readAll(*source)[1].T_WC);
}

TEST(SevenScenesFolder, TakesThePosesAsThoseOfTheDepthCamera) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  folder.write("camera.yaml",
               std::string("depth: {width: 32, height: 24, fx: 40, fy: 40, cx: 16, cy: 12, units_per_metre: 500}\n"
                           "color: {width: 32, height: 24, fx: 40, fy: 40, cx: 16, cy: 12}\n"
                           "T_color_depth: [[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_FALSE(source->description().depth_was_registered);
  EXPECT_EQ(source->description().depth_units_per_metre, 500.0);
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(frames[2].T_WC->translation().isApprox(Eigen::Vector3d(1.9, 0.5, -2)));
}

TEST(TumFolder, PairsByStampAndInterpolatesGroundTruth) {
  const TinyFolder folder;
  test::writeTum(folder);
  folder.write("groundtruth.txt", std::string("100.090 1 0 0 0 0 0 1\n100.110 2 0 0 0 0 0 1\n100.219 5 0 0 0 0 0 1\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().kind, "TUM folder");
  EXPECT_EQ(source->description().depth_units_per_metre, 5000.0);
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].name, "100.000");
  EXPECT_DOUBLE_EQ(frames[1].stamp_s, 100.1);
  EXPECT_NEAR(frames[1].depth_m(5, 6), (5100 + 12 + 5) / 5000.0f, kDepthRounding_m);
  EXPECT_FALSE(frames[0].T_WC) << "the nearest pose is 90 ms away";
  ASSERT_TRUE(frames[1].T_WC);
  EXPECT_NEAR(frames[1].T_WC->translation().x(), 1.5, 1e-6) << "half way between two poses";
  ASSERT_TRUE(frames[2].T_WC);
  EXPECT_EQ(frames[2].T_WC->translation().x(), 5.0) << "one neighbour within 20 ms: the nearest";
}

TEST(TumFolder, CountsUnpairedImages) {
  const TinyFolder folder;
  test::writeTum(folder);
  folder.write("depth.txt", std::string("100.005 depth/100.000.png\n100.150 depth/100.100.png\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().frames, 1);
  EXPECT_EQ(source->description().dropped, 3);
}

TEST(TumFolder, GuessesIntrinsicsFromTheFoldersNameAndSaysSo) {
  const TinyFolder outer;
  const std::string name = "rgbd_dataset_freiburg2_xyz";
  outer.write(name + "/rgb.txt", std::string("1.0 a.png\n"));
  outer.write(name + "/depth.txt", std::string("1.0 b.png\n"));
  outer.write(name + "/a.png", tinyColor(0, 640, 480));
  outer.write(name + "/b.png", tinyDepth(5000, 640, 480));
  const auto source = openSource((outer / name).string());
  EXPECT_EQ(source->description().camera.fx, 520.9);
  ASSERT_FALSE(source->description().remarks.empty());
  EXPECT_NE(source->description().remarks[0].find("freiburg2"), std::string::npos);
}

TEST(TumFolder, ReadsIntrinsicsYamlWithDistortion) {
  const TinyFolder folder;
  test::writeTum(folder);
  folder.write("intrinsics.yaml", std::string("fx: 30\nfy: 31\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\n"
                                              "depth_units_per_metre: 1000\ndistortion: [0.1, 0, 0, 0, 0]\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().color_camera.camera, (PinholeCamera{32, 24, 30, 31, 15.5, 11.5}));
  EXPECT_EQ(source->description().color_camera.distortion.k1, 0.1);
  EXPECT_EQ(source->description().intrinsics_origin, "intrinsics.yaml");
  EXPECT_EQ(source->description().depth_units_per_metre, 1000.0);
  ASSERT_EQ(source->description().remarks.size(), 1u);
  EXPECT_EQ(source->description().remarks[0].find("lens distortion of colour is removed"), 0u);
}

TEST(LabelledFolder, GivesLabelsOfEitherDepthAndTheIgnoreLimit) {
  const TinyFolder folder;
  test::writeLabelled(folder);
  folder.write("labels.yaml", std::string("ignore_from: 500\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().kind, "labelled frames");
  EXPECT_TRUE(source->description().has_labels);
  EXPECT_EQ(source->description().ignore_from, 500);
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].label(3, 3), 7);
  EXPECT_TRUE(frames[1].label.empty());
  EXPECT_EQ(frames[2].label(3, 3), 700);
}

TEST(LabelledFolder, FindsPosesByNameByNumberAndByOrder) {
  const TinyFolder folder;
  test::writeLabelled(folder);
  const std::string pose = " 0 0 0 0 0 1\n";
  for (const char* keys : {"a_1 a_2 a_3", "0001 0002 0003", "x y z"}) {
    std::string text;
    std::istringstream words(keys);
    int i = 0;
    for (std::string key; words >> key;) text += key + " " + std::to_string(++i) + pose;
    folder.write("groundtruth.txt", text);
    const auto source = openSource(folder.path().string());
    const std::vector<RgbdFrame> frames = readAll(*source);
    ASSERT_EQ(frames.size(), 3u);
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(frames[static_cast<std::size_t>(k)].T_WC) << keys;
      EXPECT_EQ(frames[static_cast<std::size_t>(k)].T_WC->translation().x(), k + 1) << keys;
    }
  }
}

TEST(LabelFolder, ServesLabelsKeptElsewhere) {
  const TinyFolder folder, labels;
  test::writeSevenScenes(folder);
  labels.write("label/frame-000011.png", cv::Mat(24, 32, CV_8U, cv::Scalar(3)));
  labels.write("labels.yaml", std::string("ignore_from: 100\n"));
  for (const std::filesystem::path& given : {labels.path(), labels / "label"}) {
    const auto source = openSource(folder.path().string(), {}, given);
    EXPECT_EQ(source->description().ignore_from, 100);
    const std::vector<RgbdFrame> frames = readAll(*source);
    EXPECT_TRUE(frames[0].label.empty());
    ASSERT_FALSE(frames[1].label.empty());
    EXPECT_EQ(frames[1].label(5, 5), 3);
  }
  LabelFolder by_name(labels.path());
  EXPECT_TRUE(by_name.load("frame-000011"));
  EXPECT_FALSE(by_name.load("frame-000012"));
  EXPECT_THROW((void)openSource(folder.path().string(), {}, folder / "nowhere"), IoError);
}

TEST(FrameRange, ParsesEveryPartAndRefusesTheRest) {
  EXPECT_EQ(FrameRange::parse("100:").first, 100);
  EXPECT_FALSE(FrameRange::parse("100:").end);
  EXPECT_EQ(FrameRange::parse(":50").end, 50);
  EXPECT_EQ(FrameRange::parse("::10").step, 10);
  const FrameRange all = FrameRange::parse("1:7:3");
  EXPECT_EQ(all.first, 1);
  EXPECT_EQ(all.end, 7);
  EXPECT_EQ(all.step, 3);
  for (const char* bad : {"", "5", "7:3", "1:2:0", "-1:", "a:b", "1:2:3:4", "1:2:3:", "1.5:"}) {
    EXPECT_THROW((void)FrameRange::parse(bad), std::invalid_argument) << bad;
  }
}

TEST(FrameRange, SelectsOverTheOrderOfTheSequence) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  const auto source = openSource(folder.path().string(), FrameRange::parse("0::2"));
  EXPECT_EQ(source->description().frames, 2);
  EXPECT_EQ(source->description().total_frames, 3);
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].index, FrameIndex{2});
  EXPECT_EQ(frames[1].name, "frame-000012");
  EXPECT_THROW((void)openSource(folder.path().string(), FrameRange::parse("3:")), IoError);
}

}  // namespace
}  // namespace saccade
