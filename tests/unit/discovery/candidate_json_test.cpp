#include "saccade/discovery/candidate_json.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/discovery/coco_rle.hpp"
#include "support/random_scene.hpp"

namespace saccade {
namespace {

const cv::Size kSize(120, 90);
/// Half of the last digit that is written, and single precision at a few metres.
constexpr double kDigit = 0.5e-5 + 1e-6;

Pose somewhere() {
  return Eigen::Translation3d(0.3, -1.2, 2.0) * Pose(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
}

struct Scene {
  test::RandomScene scene = test::randomScene(kSize, 40, 5);
  Candidates open, inhibited;
  CandidateOutliner outliner{DistortedPixels(scene.depth.camera)};
  CandidateBoxes boxes;

  Scene() {
    open.push_back(test::candidateOf(scene.seen, CandidateSource::kColor, {0, 3, 4}));
    open.push_back(test::candidateOf(scene.seen, CandidateSource::kDepth, {2}));
    inhibited.push_back(test::candidateOf(scene.seen, CandidateSource::kDepth, {1, 5}));
    inhibited[0].inhibited = true;
    open[0].score = 1.0 / 3.0;
    open[1].score = 1.0;
    open[0].features = {-1.5F, 2e-9F, 123456.7F};
    outliner.begin(scene.seen, open, inhibited);
    boxes.begin(scene.seen, scene.depth.vertices, somewhere());
  }

  [[nodiscard]] nlohmann::json line(const std::string& name) const {
    const std::string text = candidateLine({{7}, name, 1.25, "tracked"}, open, 1, inhibited, outliner, boxes);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return nlohmann::json::parse(text);
  }
};

TEST(CandidateJson, SaysWhatTheCandidatesAre) {
  const Scene s;
  const nlohmann::json line = s.line("frame-7");
  EXPECT_EQ(line["frame"], 7);
  EXPECT_EQ(line["name"], "frame-7");
  EXPECT_EQ(line["stamp_s"], 1.25);
  EXPECT_EQ(line["tracking"], "tracked");
  ASSERT_EQ(line["candidates"].size(), 3u);
  const auto expectCandidate = [&](const nlohmann::json& json, const Candidate& candidate) {
    cv::Mat1b mask;
    drawMask(candidate, s.scene.seen, mask);
    EXPECT_EQ(json["mask"]["size"], nlohmann::json({kSize.height, kSize.width}));
    EXPECT_EQ(json["mask"]["counts"].get<std::string>(), encodeCocoRle(mask));
    const cv::Rect& box = candidate.box;
    EXPECT_EQ(json["box"], nlohmann::json({box.x, box.y, box.width, box.height}));
    EXPECT_EQ(json["inhibited"], candidate.inhibited);
    EXPECT_NEAR(json["score"].get<double>(), candidate.score, kDigit);
    ASSERT_EQ(json["features"].size(), candidate.features.size());
    for (std::size_t i = 0; i < candidate.features.size(); ++i) {
      EXPECT_NEAR(json["features"][i].get<double>(), static_cast<double>(candidate.features[i]), kDigit);
    }
    EXPECT_EQ(json["source"], candidate.source == CandidateSource::kColor ? "colour" : "depth");
  };
  expectCandidate(line["candidates"][0], s.open[0]);
  expectCandidate(line["candidates"][1], s.open[1]);
  expectCandidate(line["candidates"][2], s.inhibited[0]);
  EXPECT_EQ(line["candidates"][0]["rank"], 0);
  EXPECT_EQ(line["candidates"][1]["rank"], 1);
  EXPECT_TRUE(line["candidates"][2]["rank"].is_null());
  EXPECT_EQ(line["candidates"][0]["attended"], true);
  EXPECT_EQ(line["candidates"][1]["attended"], false);
}

TEST(CandidateJson, NamesThatNeedEscapingStayReadable) {
  const Scene s;
  EXPECT_EQ(s.line("a \"b\" \\c")["name"], "a \"b\" \\c");
  EXPECT_NO_THROW((void)s.line("\xff\xfe"));
}

TEST(CandidateJson, AFrameWithoutCandidatesOrPoseIsALineToo) {
  Scene s;
  s.boxes.beginWithoutDepth();
  for (const nlohmann::json& candidate : s.line("x")["candidates"]) EXPECT_TRUE(candidate["box3d"].is_null());
  s.open.clear();
  EXPECT_EQ(s.line("x")["candidates"].size(), 1u);
  s.inhibited.clear();
  EXPECT_EQ(s.line("x")["candidates"].size(), 0u);
}

TEST(CandidateBoxes, AreThoseAroundTheMasksPoints) {
  const Scene s;
  for (const Candidate& candidate : {s.open[0], s.open[1], s.inhibited[0]}) {
    const auto box = s.boxes.box(candidate);
    const auto by_mask = candidateBox(candidate, s.scene.seen, s.scene.depth, somewhere());
    ASSERT_TRUE(box && by_mask);
    EXPECT_EQ(box->min(), by_mask->min());
    EXPECT_EQ(box->max(), by_mask->max());
    Eigen::AlignedBox3d expected;
    cv::Mat1b mask;
    drawMask(candidate, s.scene.seen, mask);
    for (int v = 0; v < kSize.height; ++v) {
      for (int u = 0; u < kSize.width; ++u) {
        const cv::Vec3f& p = s.scene.depth.vertices(v, u);
        if (mask(v, u) != 0 && p[2] > 0)
          expected.extend(somewhere() * Eigen::Vector3f(p[0], p[1], p[2]).cast<double>());
      }
    }
    EXPECT_TRUE(box->min().cast<double>().isApprox(expected.min(), kDigit));
    EXPECT_TRUE(box->max().cast<double>().isApprox(expected.max(), kDigit));
  }
}

}  // namespace
}  // namespace saccade
