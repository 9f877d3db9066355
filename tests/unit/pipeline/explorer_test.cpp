#include "saccade/pipeline/explorer.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "saccade/map/ior_octree.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {
namespace {

/// Width of the strip on the left of the image that the depth camera does not see.
constexpr int kStrip = 90;

/// A short look at the simulated desk, read once: images of their own, so that they stay as they are.
struct Desk {
  PinholeCamera camera;
  std::vector<RgbdFrame> frames;
};

const Desk& desk() {
  static const Desk read = [] {
    const auto source = openSource("sim:desk?frames=4", {});
    Desk result;
    result.camera = source->description().camera;
    RgbdFrame frame;
    while (source->read(frame) == ReadStatus::kFrame) {
      result.frames.push_back(frame);
      result.frames.back().color = frame.color.clone();
      result.frames.back().depth_m = frame.depth_m.clone();
      result.frames.back().depth_m(cv::Rect(0, 0, kStrip, frame.depth_m.rows)).setTo(0.0F);
    }
    return result;
  }();
  return read;
}

/// What a run leaves: its reports' candidates and poses, and its map.
struct Exploration {
  explicit Exploration(std::size_t threads, const ExplorerConfig& config = {})
      : limit(tbb::global_control::max_allowed_parallelism, threads), explorer(config, desk().camera) {}

  void process(const RgbdFrame& frame, const RgbdFrame* next) { note(explorer.process(frame, next)); }
  void note(const FrameReport& report) {
    ASSERT_EQ(report.tracking.status, TrackingStatus::kTracked);
    poses.push_back(report.tracking.T_WC.matrix());
    for (const Candidate& candidate : report.open) {
      boxes.push_back(candidate.box);
      scores.push_back(candidate.score);
    }
    completed_px.push_back(cv::countNonZero(report.depth->depth_m(cv::Rect(0, 0, kStrip, report.depth->depth_m.rows))));
  }

  tbb::global_control limit;
  Explorer explorer;
  std::vector<Eigen::Matrix4d> poses;
  std::vector<cv::Rect> boxes;
  std::vector<double> scores;
  std::vector<int> completed_px;  ///< of each frame: depth that the perceived one has in the strip
};

void expectSame(const Exploration& a, const Exploration& b) {
  EXPECT_FALSE(a.boxes.empty());
  EXPECT_EQ(a.poses, b.poses);
  EXPECT_EQ(a.boxes, b.boxes);
  EXPECT_EQ(a.scores, b.scores);
  EXPECT_EQ(a.completed_px, b.completed_px);
  EXPECT_TRUE(a.explorer.map().tree() == b.explorer.map().tree());
}

TEST(Explorer, FindsTheSameWithAndWithoutPerceivingAheadAtAnyNumberOfThreads) {
  const auto& frames = desk().frames;
  ASSERT_EQ(frames.size(), 4u);
  Exploration plain(1);
  for (const RgbdFrame& frame : frames) plain.process(frame, nullptr);
  for (const std::size_t threads : {1, 2, 4}) {
    Exploration ahead(threads);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      ahead.process(frames[i], i + 1 < frames.size() ? &frames[i + 1] : nullptr);
    }
    expectSame(plain, ahead);
  }
}

TEST(Explorer, FindsTheSameAtGivenPosesWhateverItIsToldOfTheNextFrame) {
  const auto& frames = desk().frames;
  const auto poseOf = [&](std::size_t i) { return frames[0].T_WC->inverse() * *frames[i].T_WC; };
  Exploration plain(2), ahead(2), misled(2);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const RgbdFrame* next = i + 1 < frames.size() ? &frames[i + 1] : nullptr;
    plain.note(plain.explorer.processAt(frames[i], poseOf(i)));
    ahead.note(ahead.explorer.processAt(frames[i], poseOf(i), next, poseOf(std::min(i + 1, frames.size() - 1))));
    misled.note(misled.explorer.processAt(frames[i], poseOf(i), next));
  }
  EXPECT_GT(plain.completed_px.back(), 0);
  expectSame(plain, ahead);
  expectSame(plain, misled);
}

/// What the map adds to a frame is seen and nothing more: it is not tracked, and the map does not learn it again.
TEST(Explorer, SeesBeyondTheDepthCamerasViewButLearnsNothingFromThat) {
  const auto& frames = desk().frames;
  ExplorerConfig config;
  config.completion.enabled = false;
  Exploration completing(2), plain(2, config);
  for (const RgbdFrame& frame : frames) {
    completing.process(frame, nullptr);
    plain.process(frame, nullptr);
  }
  EXPECT_EQ(completing.completed_px.front(), 0);
  EXPECT_GT(completing.completed_px.back(), 1000);
  EXPECT_EQ(plain.completed_px, std::vector<int>(frames.size(), 0));
  EXPECT_NE(completing.boxes, plain.boxes);
  EXPECT_EQ(completing.poses, plain.poses);
  EXPECT_EQ(completing.explorer.map().tree().size(), plain.explorer.map().tree().size());
  const SurfaceVolume &a = completing.explorer.surface(), &b = plain.explorer.surface();
  ASSERT_EQ(a.bricks(), b.bricks());
  for (std::size_t i = 0; i < a.bricks().size(); ++i) {
    ASSERT_EQ(a.brick(i).distance, b.brick(i).distance);
    ASSERT_EQ(a.brick(i).weight, b.brick(i).weight);
  }
}

TEST(Explorer, PerceivesAgainWhenAnotherFrameFollowsThanWasAnnounced) {
  const auto& frames = desk().frames;
  Exploration plain(2), misled(2);
  for (const RgbdFrame& frame : frames) plain.process(frame, nullptr);
  for (std::size_t i = 0; i < frames.size(); ++i) misled.process(frames[i], &frames[(i + 2) % frames.size()]);
  expectSame(plain, misled);
}

TEST(Explorer, TracksAgainWhatWasTrackedAheadWhenItIsToldWhereTheCameraIs) {
  const auto& frames = desk().frames;
  Exploration plain(2), ahead(2);
  for (Exploration* exploration : {&plain, &ahead}) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (i == 3) {  // a little off: tracking comes to another pose than from its own prediction
        Pose told(exploration->poses.back());
        told.translate(Eigen::Vector3d(0.01, 0, 0));
        exploration->explorer.placeAt(frames[2].stamp_s, told);
      }
      exploration->process(frames[i], exploration == &ahead && i < 3 ? &frames[i + 1] : nullptr);
    }
  }
  expectSame(plain, ahead);
}

/// In every look, that of the frame in work and that of the frame ahead.
TEST(Explorer, ProposesWithTheSettingsItIsGiven) {
  const auto& frames = desk().frames;
  ExplorerConfig config;
  config.discovery.proposal.min_area = 5000;
  Explorer explorer(config, desk().camera), plain({}, desk().camera);
  for (std::size_t i = 0; i < 3; ++i) {
    const FrameReport report = explorer.process(frames[i], &frames[i + 1]);
    ASSERT_FALSE(report.open.empty());
    for (const Candidate& candidate : report.open) EXPECT_GE(candidate.area, 5000);
    const FrameReport usual = plain.process(frames[i], &frames[i + 1]);
    EXPECT_TRUE(std::any_of(usual.open.begin(), usual.open.end(), [](const Candidate& c) { return c.area < 5000; }));
  }
}

/// Stares at one frame: what was looked at is forgotten in the end, and without the loss it is looked at again.
TEST(Explorer, LooksAtNewThingsBeforeForgottenOnes) {
  const auto attendedLeaves = [](double loss, bool inhibits) {
    ExplorerConfig config;
    config.map.ior = {2, 2.0};  // forgets soon
    config.discovery.ranking.top_k = 5;
    config.discovery.ranking.familiar_loss = loss;
    config.discovery.inhibition.enabled = inhibits;
    Explorer explorer(config, desk().camera);
    for (int look = 0; look < 16; ++look) (void)explorer.processAt(desk().frames.front(), Pose::Identity());
    return static_cast<double>(explorer.attendLog().leafCount());
  };
  EXPECT_GT(attendedLeaves(0.9, true), 1.1 * attendedLeaves(0.0, true));
  EXPECT_EQ(attendedLeaves(0.9, false), attendedLeaves(0.0, false)) << "without inhibition no attention has a memory";
}

TEST(Explorer, RefusesAFrameOfAnotherSizeAtItsOwnTurn) {
  const auto& frames = desk().frames;
  RgbdFrame small = frames[1];
  small.color = cv::Mat3b(10, 10, cv::Vec3b(0, 0, 0));
  Explorer explorer({}, desk().camera);
  EXPECT_EQ(explorer.process(frames[0], &small).tracking.status, TrackingStatus::kTracked);
  EXPECT_THROW(explorer.process(small), std::invalid_argument);
  EXPECT_EQ(explorer.process(frames[1]).tracking.status, TrackingStatus::kTracked);
}

}  // namespace
}  // namespace saccade
