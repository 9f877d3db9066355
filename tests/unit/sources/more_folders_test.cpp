#include <functional>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/sensor_source.hpp"
#include "support/tiny_folders.hpp"

namespace saccade {
namespace {

using test::kTinyHeight;
using test::kTinyWidth;
using test::tinyColor;
using test::tinyDepth;
using test::TinyFolder;

constexpr double kTextRounding = 1e-6;  // poses are written with about six digits

std::vector<RgbdFrame> readAll(FrameSource& source) {
  std::vector<RgbdFrame> frames;
  RgbdFrame frame;
  while (source.read(frame) == ReadStatus::kFrame) {
    RgbdFrame copy = frame;
    copy.color = frame.color.clone();
    copy.depth_m = frame.depth_m.clone();
    frames.push_back(copy);
  }
  return frames;
}

std::string padded(int number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

const char* const kTinyCameraYaml = "width: 32\nheight: 24\nfx: 40\nfy: 41\ncx: 16\ncy: 12\n";

/// `camera.yaml` for layouts whose own calibration is of 640 x 480 images.
void writeTinyCamera(const TinyFolder& folder) {
  folder.write("camera.yaml", std::string(kTinyCameraYaml));
}

TEST(IclNuimFolder, TurnsPosesOverSoThatTheCameraLooksDownItsRows) {
  const TinyFolder folder;
  writeTinyCamera(folder);
  for (int i = 0; i < 3; ++i) {
    folder.write("rgb/" + std::to_string(i) + ".png", tinyColor(i));
    folder.write("depth/" + std::to_string(i) + ".png", tinyDepth(5000));
  }
  folder.write("associations.txt", std::string("1 depth/1.png 1 rgb/1.png\n2 depth/2.png 2 rgb/2.png\n"));
  // Frame 1: one metre up; frame 2: turned about x by 90 degrees, which mirroring in y turns round.
  folder.write("livingRoom0.gt.freiburg", std::string("1 0 1 0 0 0 0 1\n2 0 0 0 0.70710678 0 0 0.70710678\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().kind, "ICL-NUIM folder");
  EXPECT_EQ(source->description().depth_units_per_metre, 5000.0);
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(cv::norm(frames[0].color, tinyColor(1), cv::NORM_INF), 0.0);
  ASSERT_TRUE(frames[0].T_WC && frames[1].T_WC);
  EXPECT_TRUE(frames[0].T_WC->translation().isApprox(Eigen::Vector3d(0, -1, 0), kTextRounding));
  EXPECT_TRUE(frames[1].T_WC->linear().isApprox(
      Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix(), kTextRounding));
}

TEST(IclNuimFolder, TakesPovRayDistancesAlongTheRay) {
  const TinyFolder folder;
  writeTinyCamera(folder);
  std::string distances;
  for (int i = 0; i < kTinyWidth * kTinyHeight; ++i) distances += "2.5 ";
  folder.write("scene_00_0007.png", tinyColor());
  folder.write("scene_00_0007.depth", distances);
  folder.write("scene_00_0007.txt", std::string("cam_pos      = [1.0, 2.0, 3.0]';\ncam_dir      = [0, 0, 1]';\n"
                                                "cam_up       = [0, 1, 0]';\n"));
  const auto source = openSource(folder.path().string());
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].depth_m(12, 16), 2.5f, 1e-6f) << "on the axis distance is depth";
  const double x = -16.0 / 40.0, y = -12.0 / 41.0;
  EXPECT_NEAR(frames[0].depth_m(0, 0), 2.5 / std::sqrt(1 + x * x + y * y), 1e-6);
  ASSERT_TRUE(frames[0].T_WC);
  EXPECT_TRUE(frames[0].T_WC->translation().isApprox(Eigen::Vector3d(1, -2, 3)));
  EXPECT_TRUE(frames[0].T_WC->linear().isApprox(Eigen::Matrix3d::Identity()));

  folder.write("scene_00_0007.depth", distances + "1");
  EXPECT_THROW((void)openSource(folder.path().string()), IoError) << "one number too many";
}

TEST(ScanNetFolder, RendersDepthIntoTheLargerColourImage) {
  const TinyFolder folder;
  for (int i = 0; i < 12; ++i) {
    folder.write("color/" + std::to_string(i) + ".jpg", tinyColor(i, 64, 48));
    folder.write("depth/" + std::to_string(i) + ".png", cv::Mat(24, 32, CV_16U, cv::Scalar(1500 + i)));
    folder.write("pose/" + std::to_string(i) + ".txt",
                 i == 5 ? std::string("-inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf")
                        : "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0 0 0 0 1");
  }
  folder.write("intrinsic/intrinsic_color.txt", std::string("80 0 32 0\n0 80 24 0\n0 0 1 0\n0 0 0 1\n"));
  folder.write("intrinsic/intrinsic_depth.txt", std::string("40 0 16 0\n0 40 12 0\n0 0 1 0\n0 0 0 1\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().kind, "ScanNet folder");
  EXPECT_EQ(source->description().camera, (PinholeCamera{64, 48, 80, 80, 32, 24}));
  EXPECT_FALSE(source->description().depth_was_registered);
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 12u);
  EXPECT_EQ(frames[10].name, "10") << "by number, not by name";
  EXPECT_EQ(frames[10].depth_m.size(), cv::Size(64, 48));
  EXPECT_NEAR(frames[10].depth_m(24, 32), 1.51f, 1e-5f);
  ASSERT_TRUE(frames[10].T_WC);
  EXPECT_EQ(frames[10].T_WC->translation().x(), 10.0);
  EXPECT_FALSE(frames[5].T_WC) << "ScanNet marks lost frames with infinite poses";
}

TEST(RtabMapFolder, TakesCameraPosesOrThoseOfTheBaseWithTheCamerasPlaceOnIt) {
  const TinyFolder folder;
  const std::string calib =
      "%YAML:1.0\n---\ncamera_name: x\nimage_width: 32\nimage_height: 24\n"
      "camera_matrix:\n   rows: 3\n   cols: 3\n   data: [ 40., 0., 16., 0., 41., 12., 0., 0., 1. ]\n"
      "local_transform:\n   rows: 3\n   cols: 4\n   data: [ 0., 0., 1., 0.5, -1., 0., 0., 0., 0., -1., 0., 0. ]\n";
  for (const char* stamp : {"1305031453.359684", "1305031453.391690"}) {
    folder.write(std::string("run_rgb/") + stamp + ".jpg", tinyColor());
    folder.write(std::string("run_depth/") + stamp + ".png", tinyDepth());
    folder.write(std::string("run_calib/") + stamp + ".yaml", calib);
  }
  folder.write("run_poses.txt", std::string("#timestamp x y z qx qy qz qw id\n"
                                            "1305031453.359684 1 0 0 0 0 0 1 1\n1305031453.391690 2 0 0 0 0 0 1 2\n"));
  {
    const auto source = openSource(folder.path().string());
    EXPECT_EQ(source->description().kind, "RTAB-Map export");
    EXPECT_EQ(source->description().camera, (PinholeCamera{32, 24, 40, 41, 16, 12}));
    const std::vector<RgbdFrame> frames = readAll(*source);
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_DOUBLE_EQ(frames[1].stamp_s, 1305031453.391690);
    ASSERT_TRUE(frames[1].T_WC);
    EXPECT_TRUE(frames[1].T_WC->translation().isApprox(Eigen::Vector3d(2.5, 0, 0)));
    EXPECT_TRUE(frames[1].T_WC->linear().col(2).isApprox(Eigen::Vector3d(1, 0, 0))) << "it looks where the robot goes";
  }
  folder.write("run_camera_poses.txt", std::string("1305031453.359684 7 0 0 0 0 0 1 1\n"));
  const std::vector<RgbdFrame> frames = readAll(*openSource(folder.path().string()));
  ASSERT_EQ(frames.size(), 2u);
  ASSERT_TRUE(frames[0].T_WC);
  EXPECT_EQ(frames[0].T_WC->translation().x(), 7.0);
  EXPECT_FALSE(frames[1].T_WC);
}

TEST(RedwoodFolder, ReadsOpen3DsIntrinsicsAndTrajectory) {
  const TinyFolder folder;
  for (int i = 1; i <= 3; ++i) {
    folder.write("rgb/" + padded(i, 7) + "-00000012345" + std::to_string(i) + ".jpg", tinyColor(i));
    folder.write("depth/" + padded(i, 7) + "-00000099999" + std::to_string(i) + ".png", tinyDepth());
  }
  folder.write("intrinsic.json",
               std::string(R"({"width": 32, "height": 24, "intrinsic_matrix": [40, 0, 0, 0, 41, 0, 16, 12, 1]})"));
  folder.write("scene.log", std::string("0 0 1\n1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
                                        "1 1 2\n1 0 0 1.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().kind, "Redwood folder");
  EXPECT_EQ(source->description().camera, (PinholeCamera{32, 24, 40, 41, 16, 12}));
  EXPECT_EQ(source->description().depth_units_per_metre, 1000.0);
  const std::vector<RgbdFrame> frames = readAll(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[1].T_WC.value().translation().x(), 1.5);
  EXPECT_FALSE(frames[2].T_WC);

  folder.write("intrinsic.json", std::string(R"({"width": 32, "intrinsic_matrix": [40, 0]})"));
  EXPECT_THROW((void)openSource(folder.path().string()), IoError);
}

TEST(RgbdScenesFolder, TellsTheTwoReleasesApart) {
  const TinyFolder one;
  writeTinyCamera(one);
  for (int i = 1; i <= 11; ++i) {
    one.write("desk_1_" + std::to_string(i) + ".png", tinyColor(i));
    one.write("desk_1_" + std::to_string(i) + "_depth.png", tinyDepth(1000));
  }
  const auto first = openSource(one.path().string());
  EXPECT_EQ(first->description().kind, "RGB-D Scenes folder");
  EXPECT_EQ(first->description().depth_units_per_metre, 1000.0);
  const std::vector<RgbdFrame> of_first = readAll(*first);
  ASSERT_EQ(of_first.size(), 11u);
  EXPECT_EQ(of_first[9].name, "desk_1_10");

  const TinyFolder two;
  two.write("imgs/scene_03/camera.yaml", std::string(kTinyCameraYaml));
  for (int i = 0; i < 2; ++i) {
    two.write("imgs/scene_03/0000" + std::to_string(i) + "-color.png", tinyColor(i));
    two.write("imgs/scene_03/0000" + std::to_string(i) + "-depth.png", tinyDepth(10000));
  }
  two.write("pc/03.pose", std::string("1 0 0 0 0 0 0\n0 0 0 1 0.5 0 0\n"));
  const auto second = openSource((two / "imgs/scene_03").string());
  EXPECT_EQ(second->description().depth_units_per_metre, 10000.0);
  const std::vector<RgbdFrame> of_second = readAll(*second);
  ASSERT_EQ(of_second.size(), 2u);
  ASSERT_TRUE(of_second[1].T_WC);
  EXPECT_EQ(of_second[1].T_WC->translation().x(), 0.5);
  EXPECT_NEAR(of_second[1].T_WC->linear()(0, 0), -1.0, kTextRounding) << "half a turn about z: w comes first";
}

TEST(PlainFolder, PairsAsItsYamlSays) {
  const TinyFolder folder;
  for (int i = 0; i < 3; ++i) {
    folder.write("left/img" + std::to_string(i) + ".png", tinyColor(i));
    folder.write("d/img" + std::to_string(i + 1) + ".png", tinyDepth(2560 + i));
  }
  folder.write("track.txt", std::string("0.1 1 0 0 0 0 0 1\n"));
  const auto open = [&](const std::string& images) {
    folder.write("camera.yaml", std::string("images: {color: left, depth: d, ") + images +
                                    "}\ncolor: {width: 32, height: 24, fx: 40, fy: 41, cx: 16, cy: 12}\n"
                                    "depth: {units_per_metre: 256}\n");
    return openSource(folder.path().string());
  };
  const auto by_number = open("pair_by: number, frames_per_second: 10, poses: track.txt");
  EXPECT_EQ(by_number->description().kind, "plain folder");
  EXPECT_EQ(by_number->description().frames, 2);
  EXPECT_EQ(by_number->description().dropped, 2);
  const std::vector<RgbdFrame> frames = readAll(*by_number);
  EXPECT_DOUBLE_EQ(frames.at(0).stamp_s, 0.1);
  EXPECT_NEAR(frames.at(0).depth_m(5, 6), (2560 + 12 + 5) / 256.0f, 1e-5f);
  EXPECT_EQ(frames.at(0).T_WC.value().translation().x(), 1.0);
  EXPECT_EQ(open("pair_by: name")->description().frames, 2);
  EXPECT_EQ(open("pair_by: order")->description().frames, 3);
  EXPECT_THROW((void)open("pair_by: luck"), IoError);
  EXPECT_THROW((void)open("frames_per_second: 0"), IoError);
}

TEST(CalibrationYaml, IsReadBackToTheSameNumbers) {
  RgbdCalibration written;
  written.color = {640, 480, 521.03, 520.0 / 3.0, 320.25, 239.56};
  written.color_distortion = {-0.0247, -0.10528, 1e-4, -2e-5, 0.1};
  written.depth = DepthCamera{{320, 240, 285.0, 285.5, 160.1, 120.2}, {0.01, 0, 0, 0, 0}, Pose::Identity()};
  written.depth->T_CD.translate(Eigen::Vector3d(-0.0255, 1.0 / 3.0, 0));
  written.depth_units_per_metre = 6553.5;
  written.depth_invalid = {0, 4095};
  written.depth_along_ray = true;
  const TinyFolder folder;
  folder.write("camera.yaml", calibrationYaml(written));
  const RgbdCalibration read = loadCalibrationYaml(folder / "camera.yaml");
  EXPECT_EQ(read.color, written.color);
  EXPECT_EQ(read.color_distortion.k2, written.color_distortion.k2);
  EXPECT_EQ(read.color_distortion.k3, written.color_distortion.k3);
  ASSERT_TRUE(read.depth);
  EXPECT_EQ(read.depth->camera, written.depth->camera);
  EXPECT_EQ(read.depth->distortion.k1, written.depth->distortion.k1);
  EXPECT_EQ(read.depth->T_CD.matrix(), written.depth->T_CD.matrix());
  EXPECT_EQ(read.depth_units_per_metre, written.depth_units_per_metre);
  EXPECT_EQ(read.depth_invalid, written.depth_invalid);
  EXPECT_TRUE(read.depth_along_ray);
}

TEST(SensorSource, GivesImagesAsStoredWhereOpenSourceGivesIdealOnes) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  folder.write("camera.yaml",
               std::string("depth: {width: 32, height: 24, fx: 40, fy: 40, cx: 16, cy: 12, units_per_metre: 1000}\n"
                           "color: {width: 32, height: 24, fx: 40, fy: 40, cx: 16, cy: 12, distortion: [0.3,0,0,0]}\n"
                           "T_color_depth: [[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\n"));
  const auto sensor = openSensorSource(folder.path().string());
  SensorFrame stored;
  ASSERT_EQ(sensor->read(stored), ReadStatus::kFrame);
  EXPECT_EQ(cv::norm(stored.color, tinyColor(0), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(stored.raw_depth, tinyDepth(1000), cv::NORM_INF), 0.0);
  const auto ideal = openSource(folder.path().string());
  RgbdFrame frame;
  ASSERT_EQ(ideal->read(frame), ReadStatus::kFrame);
  EXPECT_GT(cv::norm(frame.color, tinyColor(0), cv::NORM_INF), 0.0);
  EXPECT_EQ(ideal->description().remarks, (std::vector<std::string>{"depth is rendered into the colour camera",
                                                                    "lens distortion of colour is removed"}));
}

}  // namespace
}  // namespace saccade
