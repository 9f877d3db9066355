#include "saccade/pipeline/explorer.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "saccade/map/ior_octree.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {
namespace {

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
    }
    return result;
  }();
  return read;
}

/// What a run leaves: its reports' candidates and poses, and its map.
struct Exploration {
  explicit Exploration(std::size_t threads) : limit(tbb::global_control::max_allowed_parallelism, threads) {}

  void process(const RgbdFrame& frame, const RgbdFrame* next) {
    const FrameReport report = explorer.process(frame, next);
    ASSERT_EQ(report.tracking.status, TrackingStatus::kTracked);
    poses.push_back(report.tracking.T_WC.matrix());
    for (const Candidate& candidate : report.open) {
      boxes.push_back(candidate.box);
      scores.push_back(candidate.score);
    }
  }

  tbb::global_control limit;
  Explorer explorer{{}, desk().camera};
  std::vector<Eigen::Matrix4d> poses;
  std::vector<cv::Rect> boxes;
  std::vector<double> scores;
};

void expectSame(const Exploration& a, const Exploration& b) {
  EXPECT_FALSE(a.boxes.empty());
  EXPECT_EQ(a.poses, b.poses);
  EXPECT_EQ(a.boxes, b.boxes);
  EXPECT_EQ(a.scores, b.scores);
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
