#include "saccade/evaluation/run_score.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/discovery/coco_rle.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

const cv::Size kSize(64, 48);

RecordedCandidate candidate(const cv::Rect& box, std::optional<double> revisited_share, bool attended = true) {
  cv::Mat1b mask(kSize, std::uint8_t{0});
  mask(box) = 255;
  return {box, encodeCocoRle(mask), attended, revisited_share};
}

RecordedFrame frame(const std::string& name, std::vector<RecordedCandidate> open) {
  RecordedFrame recorded;
  recorded.name = name;
  recorded.open = std::move(open);
  recorded.inhibited = 3;
  return recorded;
}

TEST(ScoreRun, CountsARevisitFromHalfOfTheLeavesOnAmongTheAttended) {
  RunRecording recording;
  recording.image_size = kSize;
  const cv::Rect box(5, 5, 20, 20);
  recording.frames = {frame("a", {candidate(box, 0.0), candidate(box, 0.49), candidate(box, 0.5), candidate(box, 1.0)}),
                      frame("b", {candidate(box, 1.0), candidate(box, 1.0, false)}), frame("c", {})};
  const RunScore score = scoreRun(recording, {}, {});
  EXPECT_EQ(score.revisit_rate, (std::vector<double>{0.5, 1.0, 1.0}));  // "c" attended nothing: as before
  EXPECT_DOUBLE_EQ(score.meanRevisitRate(), 2.5 / 3);
  EXPECT_EQ(score.labelled, 0);
  EXPECT_DOUBLE_EQ(score.inhibited, 3.0);
}

TEST(ScoreRun, JudgesOnlyFramesWithALabelAndKnowsWhereTheyAre) {
  cv::Mat1w label(kSize, std::uint16_t{0});
  label(cv::Rect(5, 5, 20, 20)) = 9;
  LabelFrames labels;
  labels.add("b", label);
  RunRecording recording;
  recording.image_size = kSize;
  recording.frames = {frame("a", {}), frame("b", {candidate({5, 5, 20, 20}, std::nullopt)})};
  const RunScore score = scoreRun(recording, labels, {});
  EXPECT_EQ(score.labelled_frames, std::vector<int>{1});
  EXPECT_DOUBLE_EQ(score.boxes.recall(1), 1.0);
  EXPECT_DOUBLE_EQ(score.masks.recall(1), 1.0);
  EXPECT_TRUE(score.revisit_rate.empty());
}

TEST(LoadRecording, ReadsCandidateLinesAndNamesADamagedOne) {
  const test::TemporaryFolder folder;
  const std::string good =
      R"({"frame":4,"name":"frame-000004","stamp_s":0.13,"tracking":"tracked","candidates":[)"
      R"({"rank":0,"score":0.9,"attended":true,"inhibited":false,"box":[1,2,3,4],"source":"depth",)"
      R"("mask":{"size":[48,64],"counts":"0"},"box3d":null,"features":[]},)"
      R"({"rank":null,"score":0.0,"attended":false,"inhibited":true,"box":[1,2,3,4],"source":"depth",)"
      R"("mask":{"size":[48,64],"counts":"0"},"box3d":null,"features":[]}]})";
  std::ofstream(folder / "good.jsonl") << good << "\n";
  const RunRecording recording = loadRecording(folder / "good.jsonl");
  ASSERT_EQ(recording.frames.size(), 1U);
  EXPECT_EQ(recording.image_size, kSize);
  EXPECT_EQ(recording.frames[0].index.value, 4);
  EXPECT_EQ(recording.frames[0].inhibited, 1);
  ASSERT_EQ(recording.frames[0].open.size(), 1U);
  EXPECT_EQ(recording.frames[0].open[0].box, cv::Rect(1, 2, 3, 4));
  EXPECT_TRUE(recording.frames[0].open[0].attended);

  std::ofstream(folder / "cut.jsonl") << good << "\n" << good.substr(0, 100) << "\n";
  try {
    (void)loadRecording(folder / "cut.jsonl");
    FAIL() << "a damaged line was read";
  } catch (const IoError& error) {
    EXPECT_NE(error.expected().find("line 2"), std::string::npos) << error.what();
  }
  std::ofstream(folder / "empty.jsonl") << "";
  EXPECT_THROW((void)loadRecording(folder / "empty.jsonl"), IoError);
  EXPECT_THROW((void)loadRecording(folder / "none.jsonl"), IoError);
}

}  // namespace
}  // namespace saccade
