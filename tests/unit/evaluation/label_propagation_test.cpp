#include "saccade/evaluation/label_propagation.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/sources/label_folder.hpp"
#include "support/depth_scene.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

/// Objects' edges are a leaf wide: 1 cm at 1.3 m and 146 px focal length is 1.1 px of balls of about 40 px.
constexpr double kFewestIou = 0.85;

/// Ball i of the scene is object i + 1.
cv::Mat1w exactLabel(const test::DepthScene& scene, const PinholeCamera& camera, const Pose& T_WC) {
  cv::Mat1w label(camera.height, camera.width, std::uint16_t{0});
  for (int v = 0; v < label.rows; ++v) {
    for (int u = 0; u < label.cols; ++u) {
      const double first = scene.meetPixel(camera, T_WC, u, v).s;
      for (std::size_t i = 0; i < scene.balls.size(); ++i) {
        const test::DepthScene alone{{}, {scene.balls[i]}};
        if (alone.meetPixel(camera, T_WC, u, v).s == first) label(v, u) = static_cast<std::uint16_t>(i + 1);
      }
    }
  }
  return label;
}

struct Sequence {
  PinholeCamera camera = test::smallCamera();
  IorMap map;
  std::vector<PosedFrame> frames;
  LabelFrames truth;
};

void walkAlong(Sequence& sequence, const test::DepthScene& scene, int count) {
  for (int i = 0; i < count; ++i) {
    const Pose T_WC = test::poseOf({0, 1, 0}, 1.0 * i, {-0.01 * i, 0, 0});
    const std::string name = "f" + std::to_string(i);
    sequence.map.integrate(prepareDepth(scene.render(sequence.camera, T_WC), sequence.camera), {}, T_WC);
    sequence.frames.push_back({name, T_WC});
    sequence.truth.add(name, exactLabel(scene, sequence.camera, T_WC));
  }
}

LabelFrames onlyEvery(const Sequence& sequence, std::size_t n) {
  LabelFrames given;
  for (std::size_t i = 0; i < sequence.frames.size(); i += n) {
    given.add(sequence.frames[i].name, *sequence.truth.find(sequence.frames[i].name));
  }
  return given;
}

TEST(PropagateLabels, AgreesWithTheTruthOfTheFramesBetween) {
  Sequence sequence;
  walkAlong(sequence, test::cornerWithBalls(), 9);
  const DistortedPixels ideal(sequence.camera);
  const LabelFrames given = onlyEvery(sequence, 4);
  const LabelFrames all = propagateLabels(sequence.map, sequence.camera, ideal, sequence.frames, given);
  EXPECT_EQ(all.size(), sequence.frames.size());
  const LabelAgreement agreement = compareLabels(all, sequence.truth, given, sequence.frames, 200);
  EXPECT_GE(agreement.objects, 12);  // three balls, six frames, some leave the view
  EXPECT_GT(agreement.mean_iou, kFewestIou);
  // The given ones are not touched.
  EXPECT_EQ(cv::countNonZero(*all.find("f4") != *sequence.truth.find("f4")), 0);
}

TEST(PropagateLabels, WorksInThePixelsOfAnInputWithLensDistortion) {
  Sequence sequence;
  walkAlong(sequence, test::cornerWithBalls(), 5);
  const DistortedPixels pixels(sequence.camera, {sequence.camera, LensDistortion{-0.15, 0.03, 0.0, 0.0, 0.0}});
  LabelFrames truth, given;
  for (const PosedFrame& frame : sequence.frames) {
    cv::Mat1w distorted;
    pixels.distort(*sequence.truth.find(frame.name), distorted, std::uint16_t{0});
    truth.add(frame.name, distorted);
    if (frame.name == "f0" || frame.name == "f4") given.add(frame.name, distorted);
  }
  const LabelFrames all = propagateLabels(sequence.map, sequence.camera, pixels, sequence.frames, given);
  EXPECT_GT(compareLabels(all, truth, given, sequence.frames, 200).mean_iou, kFewestIou);
}

TEST(PropagateLabels, RefusesASequenceWithoutLabels) {
  Sequence sequence;
  walkAlong(sequence, test::cornerWithBalls(), 1);
  const DistortedPixels ideal(sequence.camera);
  EXPECT_THROW((void)propagateLabels(sequence.map, sequence.camera, ideal, sequence.frames, {}), std::invalid_argument);
}

TEST(LabelFrames, AreReadBackFromTheFolderTheyWereWrittenTo) {
  const test::TemporaryFolder folder;
  cv::Mat1w label(20, 30, std::uint16_t{0});
  label(cv::Rect(3, 4, 10, 5)) = 777;
  LabelFrames frames;
  frames.add("one", label);
  frames.save(folder / "masks", 700);
  LabelFolder back(folder / "masks");
  EXPECT_EQ(back.ignoreFrom(), 700);
  ASSERT_TRUE(back.load("one"));
  EXPECT_EQ(cv::countNonZero(*back.load("one") != label), 0);
  EXPECT_FALSE(back.load("two"));
  EXPECT_FALSE(frames.find("two"));
}

TEST(LabelFrames, NameAFolderThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "file") << "x";
  LabelFrames frames;
  frames.add("one", cv::Mat1w(4, 4, std::uint16_t{1}));
  EXPECT_THROW(frames.save(folder / "file", std::nullopt), IoError);
}

}  // namespace
}  // namespace saccade
