#include <functional>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/image_files.hpp"
#include "support/tiny_folders.hpp"

namespace saccade {
namespace {

using test::tinyColor;
using test::tinyDepth;
using test::TinyFolder;

/// The message of the IoError that `act` throws; empty, and a failure, if it throws none.
std::string messageOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const IoError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no IoError";
  return "";
}

std::string messageOfOpening(const TinyFolder& folder) {
  return messageOf([&] { (void)openSource(folder.path().string()); });
}

void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "\"" << part << "\" is not in: " << text;
}

/// Reads a folder of three frames whose middle one is bad; returns the reason given for skipping it.
std::string reasonOfSkippingTheSecond(const TinyFolder& folder) {
  const auto source = openSource(folder.path().string());
  RgbdFrame frame;
  EXPECT_EQ(source->read(frame), ReadStatus::kFrame);
  EXPECT_EQ(source->read(frame), ReadStatus::kSkip);
  EXPECT_EQ(frame.index, FrameIndex{1});
  const std::string reason = source->skipReason();
  EXPECT_EQ(source->read(frame), ReadStatus::kFrame);
  EXPECT_EQ(frame.index, FrameIndex{2});
  EXPECT_EQ(source->read(frame), ReadStatus::kEnd);
  EXPECT_EQ(source->read(frame), ReadStatus::kEnd);
  return reason;
}

TEST(OpenSource, NamesAFolderThatIsMissing) {
  expectContains(messageOf([] { (void)openSource("no/such/folder"); }), "nothing of that name");
}

TEST(OpenSource, SaysWhatItLookedForAndFound) {
  const TinyFolder folder;
  expectContains(messageOfOpening(folder), "an empty folder");
  folder.write("notes.txt", std::string("hello"));
  const std::string message = messageOfOpening(folder);
  expectContains(message, "frame-NNNNNN.color.png (7-Scenes)");
  expectContains(message, "rgb.txt and depth.txt (TUM)");
  expectContains(message, "labelled frames");
  expectContains(message, "notes.txt");
  expectContains(messageOf([&] { (void)openSource((folder / "notes.txt").string()); }), "a file");
}

TEST(OpenSource, NamesSwappedColourAndDepthLists) {
  const TinyFolder folder;
  test::writeTum(folder);
  std::filesystem::rename(folder / "rgb.txt", folder / "x");
  std::filesystem::rename(folder / "depth.txt", folder / "rgb.txt");
  std::filesystem::rename(folder / "x", folder / "depth.txt");
  expectContains(messageOfOpening(folder), "colour and depth look swapped");
}

TEST(OpenSource, RefusesEightBitDepth) {
  const TinyFolder folder;
  test::writeLabelled(folder);
  for (int i = 1; i <= 3; ++i) {
    folder.write("depth/a_" + std::to_string(i) + ".png", cv::Mat(24, 32, CV_8U, cv::Scalar(9)));
  }
  expectContains(messageOfOpening(folder), "8-bit depth is a picture of depth");
}

TEST(OpenSource, RefusesDepthWithoutAnyMeasurement) {
  const TinyFolder folder;
  test::writeLabelled(folder);
  for (int i = 1; i <= 3; ++i) {
    folder.write("depth/a_" + std::to_string(i) + ".png", cv::Mat(24, 32, CV_16U, cv::Scalar(i == 2 ? 65535 : 0)));
  }
  expectContains(messageOfOpening(folder), "some pixels with a depth measurement, found none");
}

TEST(OpenSource, RefusesImagesOfAnotherSizeThanTheCamera) {
  const TinyFolder folder;
  test::writeTum(folder);
  folder.write("camera.txt", std::string("525 525 319.5 239.5 640 480 5000\n"));
  const std::string message = messageOfOpening(folder);
  expectContains(message, "640 x 480 px (camera.txt)");
  expectContains(message, "found 32 x 24 px");
}

TEST(OpenSource, RefusesEmptyAndBrokenLists) {
  const TinyFolder folder;
  test::writeTum(folder);
  folder.write("depth.txt", std::string("# nothing\n"));
  expectContains(messageOfOpening(folder), "an empty list");
  folder.write("depth.txt", std::string("100.0\n"));
  expectContains(messageOfOpening(folder), "line 1");
  folder.write("depth.txt", std::string("555.0 depth/100.000.png\n"));
  expectContains(messageOfOpening(folder), "within 20 ms");
}

TEST(OpenSource, RefusesBadIntrinsics) {
  const TinyFolder folder;
  test::writeTum(folder);
  for (const char* bad : {"nan 41 16 12 32 24 5000", "40 41 16 12 32 24", "40 41 16 12 32 24 0", "0 41 16 12 32 24 1",
                          "40 41 16 12 1e9 24 1", "", "# only a comment"}) {
    folder.write("camera.txt", std::string(bad) + "\n");
    EXPECT_THROW((void)openSource(folder.path().string()), IoError) << bad;
  }
  for (const char* bad :
       {"fx: 1", "[", "fx: 40\nfy: 40\ncx: 1\ncy: .nan\nwidth: 32\nheight: 24\n",
        "fx: 40\nfy: 40\ncx: 1\ncy: 1\nwidth: 32\nheight: 24\ndistortion: [1]\n",
        "fx: 40\nfy: 40\ncx: 1\ncy: 1\nwidth: 32\nheight: 24\n"
        "depth: {width: 32, height: 24, fx: 40, fy: 40, cx: 1, cy: 1}\nT_color_depth: [[2,0],[0,1]]\n"}) {
    folder.write("intrinsics.yaml", std::string(bad));
    EXPECT_THROW((void)openSource(folder.path().string()), IoError) << bad;
  }
}

TEST(OpenSource, LeavesPosesThatAreNotPosesOutAndSaysSo) {
  const TinyFolder folder;
  test::writeTum(folder);
  folder.write("groundtruth.txt", std::string("100.000 nan 0 0 0 0 0 1\n100.100 1 0 0 0 0 0 9\nx y z\n"
                                              "100.200 4 0 0 0 0 0 1\n"));
  const auto source = openSource(folder.path().string());
  EXPECT_EQ(source->description().remarks.at(0), "3 lines of groundtruth.txt are not poses");
  EXPECT_EQ(source->description().remarks.at(1), "2 frames without a ground-truth pose within 20 ms");
}

TEST(BadFrame, TruncatedPngIsSkippedWithItsReason) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  folder.truncate("frame-000011.depth.png", 0.8);
  const std::string reason = reasonOfSkippingTheSecond(folder);
  expectContains(reason, "frame-000011.depth.png");
  expectContains(reason, "truncated");
}

TEST(BadFrame, TruncatedJpegIsSkippedWithItsReason) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  std::filesystem::remove(folder / "frame-000011.color.png");
  folder.write("frame-000011.color.jpg", tinyColor());
  folder.truncate("frame-000011.color.jpg", 0.9);
  expectContains(reasonOfSkippingTheSecond(folder), "a complete JPEG image, found a truncated one");
}

TEST(BadFrame, ForeignEmptyAndMissingFilesAreSkipped) {
  for (const std::string& content : {std::string("not an image at all"), std::string()}) {
    const TinyFolder folder;
    test::writeSevenScenes(folder);
    folder.write("frame-000011.color.png", content);
    expectContains(reasonOfSkippingTheSecond(folder), content.empty() ? "an empty file" : "another kind of file");
  }
  const TinyFolder folder;
  test::writeTum(folder);
  std::filesystem::remove(folder / "rgb/100.100.png");
  expectContains(reasonOfSkippingTheSecond(folder), "nothing that can be read");
}

TEST(BadFrame, AnotherSizeIsSkipped) {
  const TinyFolder folder;
  test::writeSevenScenes(folder);
  folder.write("frame-000011.depth.png", tinyDepth(1000, 16, 12));
  expectContains(reasonOfSkippingTheSecond(folder),
                 "32 x 24 px, as the colour image it is registered to, found 16 x 12");
}

TEST(BadFrame, ALabelThatIsAPictureIsSkipped) {
  const TinyFolder folder;
  test::writeLabelled(folder);
  folder.write("label/a_2.png", tinyColor());
  expectContains(reasonOfSkippingTheSecond(folder), "a label image with 1 channel");
}

TEST(ImageReader, NeverTakesAnyPrefixOfAFileForTheWholeImage) {
  const TinyFolder folder;
  folder.write("a.png", tinyDepth());
  folder.write("a.jpg", tinyColor());
  ImageReader reader;
  cv::Mat1w depth;
  cv::Mat3b color;
  for (const std::string& name : {std::string("a.png"), std::string("a.jpg")}) {
    std::ifstream file(folder / name, std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    for (std::size_t length = 0; length + 2 < whole.size(); length += 3) {
      folder.write("cut", whole.substr(0, length));
      if (name == "a.png") {
        EXPECT_THROW(reader.readDepth(folder / "cut", depth), IoError) << length;
      } else {
        EXPECT_THROW(reader.readColor(folder / "cut", color), IoError) << length;
      }
    }
  }
}

}  // namespace
}  // namespace saccade
