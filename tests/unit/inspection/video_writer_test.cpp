#include "saccade/inspection/video_writer.hpp"

#include <filesystem>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/videoio.hpp>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

std::filesystem::path temporaryVideo(const char* name) {
  return std::filesystem::temp_directory_path() / name;
}

int countFrames(const std::filesystem::path& path) {
  cv::VideoCapture capture(path.string(), cv::CAP_FFMPEG);
  int frames = 0;
  cv::Mat frame;
  while (capture.read(frame)) ++frames;
  return frames;
}

TEST(VideoWriter, EveryPictureComesBackWithItsColour) {
  const auto path = temporaryVideo("saccade-video-colour.mp4");
  VideoWriter writer(path, {64, 48}, 30.0);
  for (int i = 0; i < 10; ++i) writer.write(cv::Mat3b(48, 64, cv::Vec3b(200, 100, 50)));
  writer.finish();
  EXPECT_EQ(countFrames(path), 10);
  cv::VideoCapture capture(path.string(), cv::CAP_FFMPEG);
  cv::Mat3b frame;
  ASSERT_TRUE(capture.read(frame));
  constexpr double kLossyCodec = 12.0;  // chroma subsampling and range conversion, in grey levels
  EXPECT_LT(cv::norm(frame(24, 32), cv::Vec3b(200, 100, 50), cv::NORM_INF), kLossyCodec);
  std::filesystem::remove(path);
}

TEST(VideoWriter, WhatWasWrittenIsReadableBeforeTheFileIsFinished) {
  const auto path = temporaryVideo("saccade-video-cut.mp4");
  const auto copy = temporaryVideo("saccade-video-cut-copy.mp4");
  VideoWriter writer(path, {64, 48}, 30.0);
  for (int i = 0; i < 200; ++i) writer.write(cv::Mat3b(48, 64, cv::Vec3b(static_cast<uchar>(i), 100, 50)));
  std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);  // as after kill -9
  EXPECT_GE(countFrames(copy), 100);
  writer.finish();
  EXPECT_EQ(countFrames(path), 200);
  std::filesystem::remove(path);
  std::filesystem::remove(copy);
}

TEST(VideoWriter, RefusesOddSidesOtherSizesAndPathsThatCannotBeWritten) {
  EXPECT_THROW(VideoWriter("odd.mp4", {63, 48}, 30.0), std::invalid_argument);
  EXPECT_THROW(VideoWriter("no/such/folder/v.mp4", {64, 48}, 30.0), IoError);
  const auto path = temporaryVideo("saccade-video-size.mp4");
  VideoWriter writer(path, {64, 48}, 30.0);
  EXPECT_THROW(writer.write(cv::Mat3b(48, 66)), std::invalid_argument);
  std::filesystem::remove(path);
}

TEST(VideoWriter, SaysWhenTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(
      {
        VideoWriter writer("/dev/full", {64, 48}, 30.0);
        for (int i = 0; i < 500; ++i) writer.write(cv::Mat3b(48, 64, cv::Vec3b(static_cast<uchar>(i), 0, 0)));
        writer.finish();
      },
      IoError);
}

}  // namespace
}  // namespace saccade
