#include <functional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "saccade/preflight/preflight.hpp"
#include "support/tiny_folders.hpp"

namespace saccade {
namespace {

using test::TinyFolder;

constexpr int kWidth = 64, kHeight = 48;
constexpr int kFrames = 60;
constexpr double kPeriod_s = 1.0 / 30.0;

/// A TUM folder whose parts can be damaged one by one.
struct Recording {
  std::function<bool(int)> has_color = [](int) { return true; }, has_depth = has_color;
  std::function<double(int)> color_stamp_s = [](int i) { return 1000.0 + i * kPeriod_s; };
  std::function<double(int)> depth_stamp_s = [](int i) { return 1000.004 + i * kPeriod_s; };
  std::function<cv::Mat(int)> color = [](int i) { return cv::Mat(test::tinyColor(i, kWidth, kHeight)); };
  std::function<cv::Mat(int)> depth = [](int i) { return cv::Mat(test::tinyDepth(8000 + i, kWidth, kHeight)); };
  const char *color_list = "rgb.txt", *depth_list = "depth.txt";

  void write(const TinyFolder& folder) const {
    std::string colors, depths;
    for (int i = 0; i < kFrames; ++i) {
      const std::string file = std::to_string(i) + ".png";
      if (has_color(i)) colors += std::to_string(color_stamp_s(i)) + " rgb/" + file + "\n";
      if (has_depth(i)) depths += std::to_string(depth_stamp_s(i)) + " depth/" + file + "\n";
      folder.write("rgb/" + file, color(i));
      folder.write("depth/" + file, depth(i));
    }
    folder.write(color_list, colors);
    folder.write(depth_list, depths);
    folder.write("camera.txt", std::string("60 60 31.5 23.5 64 48 5000\n"));
  }
};

/// The finding of that code; fails the test if there is none or if it is not as grave.
std::string textOf(const PreflightReport& report, const std::string& code, FindingSeverity severity) {
  std::string others;
  for (const PreflightFinding& finding : report.findings) {
    if (finding.code == code && finding.severity == severity) return finding.text;
    others += std::string(" ") + nameOf(finding.severity) + " " + finding.code + ": " + finding.text;
  }
  ADD_FAILURE() << "no " << nameOf(severity) << " " << code << " but" << others;
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Preflight, NamesAnEmptyFolderAndAFolderThatIsNotThere) {
  const TinyFolder folder;
  const PreflightReport empty = preflight(folder.path().string());
  EXPECT_TRUE(empty.wouldFail());
  EXPECT_PRED2(contains, textOf(empty, "cannot-open", FindingSeverity::kFault), "an empty folder");
  EXPECT_PRED2(contains, textOf(preflight("/no/such/folder"), "cannot-open", FindingSeverity::kFault),
               "nothing of that name");
}

TEST(Preflight, NamesListsInEachOthersPlace) {
  const TinyFolder folder;
  Recording recording;
  std::swap(recording.color_list, recording.depth_list);
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "swapped-lists", FindingSeverity::kFault),
               "in each other's place");
}

TEST(Preflight, NamesFoldersOfColourAndDepthInEachOthersPlace) {
  const TinyFolder folder;
  Recording recording;
  std::swap(recording.color, recording.depth);
  recording.write(folder);
  (void)textOf(preflight(folder.path().string()), "swapped-lists", FindingSeverity::kFault);
}

TEST(Preflight, NamesDepthOfEightBits) {
  const TinyFolder folder;
  Recording recording;
  recording.depth = [](int i) { return cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(40 + i)); };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "depth-8-bit", FindingSeverity::kFault),
               "1 channel of 8 bits");
}

TEST(Preflight, NamesImagesTurnedByNinetyDegrees) {
  const TinyFolder folder;
  Recording recording;
  recording.color = [](int i) { return cv::Mat(test::tinyColor(i, kHeight, kWidth)); };
  recording.depth = [](int i) { return cv::Mat(test::tinyDepth(8000 + i, kHeight, kWidth)); };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "rotated-images", FindingSeverity::kFault),
               "48 x 64");
}

TEST(Preflight, NamesIntrinsicsOfAnotherSize) {
  const TinyFolder folder;
  Recording recording;
  recording.color = [](int i) { return cv::Mat(test::tinyColor(i, 2 * kWidth, 2 * kHeight)); };
  recording.depth = [](int i) { return cv::Mat(test::tinyDepth(8000 + i, 2 * kWidth, 2 * kHeight)); };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "wrong-size", FindingSeverity::kFault), "128 x 96");
}

TEST(Preflight, NamesDepthOfAnotherSizeThanColour) {
  const TinyFolder folder;
  Recording recording;
  recording.depth = [](int i) { return cv::Mat(test::tinyDepth(8000 + i, kWidth / 2, kHeight / 2)); };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "wrong-size", FindingSeverity::kFault),
               "depth is 32 x 24");
}

TEST(Preflight, NamesAnImageThatCannotBeRead) {
  const TinyFolder folder;
  Recording().write(folder);
  folder.truncate("rgb/7.png", 0.5);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "unreadable-images", FindingSeverity::kWarning),
               "rgb/7.png");
}

TEST(Preflight, NamesHalfOfTheFilesMissing) {
  const TinyFolder folder;
  Recording().write(folder);
  for (int i = 0; i < kFrames; i += 2) std::filesystem::remove(folder / ("depth/" + std::to_string(i) + ".png"));
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "missing-images", FindingSeverity::kFault),
               "30 of 60 frames");
}

TEST(Preflight, NamesHalfOfTheDepthListMissing) {
  const TinyFolder folder;
  Recording recording;
  recording.has_depth = [](int i) { return i % 2 == 0; };
  recording.write(folder);
  (void)textOf(preflight(folder.path().string()), "unmatched", FindingSeverity::kWarning);
}

TEST(Preflight, NamesEveryOtherFrameMissingHereAndThere) {
  const TinyFolder folder;
  Recording recording;
  recording.has_color = recording.has_depth = [](int i) { return i < 20 || i >= 32; };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "stamp-gaps", FindingSeverity::kWarning),
               "12 frames of colour are missing");
}

TEST(Preflight, NamesStampsThatAreShifted) {
  for (const double shift_s : {0.5, -0.2, 100.0}) {
    const TinyFolder folder;
    Recording recording;
    recording.depth_stamp_s = [&](int i) { return 1000.0 + shift_s + i * kPeriod_s; };
    recording.write(folder);
    EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "stamp-shift", FindingSeverity::kFault),
                 shift_s > 0 ? "after those of colour" : "before those of colour");
  }
}

TEST(Preflight, NamesStampsThatDrift) {
  const TinyFolder folder;
  Recording recording;
  recording.depth_stamp_s = [](int i) { return 1000.0 + 1.01 * i * kPeriod_s; };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "stamp-drift", FindingSeverity::kFault),
               "1.00 % slower");
}

TEST(Preflight, NamesStampsThatComeTwice) {
  const TinyFolder folder;
  Recording recording;
  recording.color_stamp_s = [](int i) { return 1000.0 + (i - i % 2) * kPeriod_s; };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "stamp-duplicates", FindingSeverity::kWarning),
               "30 of 60");
}

TEST(Preflight, NamesDepthThatHoldsNothing) {
  const TinyFolder folder;
  Recording recording;
  recording.depth = [](int) { return cv::Mat(kHeight, kWidth, CV_16U, cv::Scalar(0)); };
  recording.write(folder);
  EXPECT_PRED2(contains, textOf(preflight(folder.path().string()), "cannot-open", FindingSeverity::kFault),
               "some pixels with a depth measurement");
}

}  // namespace
}  // namespace saccade
