// In the steady state the stages take no fresh memory: their buffers have grown to what frames need.

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>
#include <tbb/global_control.h>

#include "allocations/counted_allocations.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/candidate_outline.hpp"
#include "saccade/discovery/perceiver.hpp"
#include "saccade/discovery/proposals.hpp"
#include "saccade/discovery/ranker.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/rendering/back_project.hpp"
#include "saccade/rendering/renderer.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/tracking/tracker.hpp"

namespace saccade {
namespace {

struct Frame {
  cv::Mat3b color;
  cv::Mat1f depth_m;
  DepthMaps depth;
  Pose T_WC;
  Perception seen;
};

/// Some frames of the simulated desk, prepared and perceived.
struct Desk {
  PinholeCamera camera;
  std::vector<std::unique_ptr<Frame>> frames;
};

const Desk& desk() {
  static const Desk read = [] {
    cv::setNumThreads(1);
    const auto source = openSource("sim:desk?frames=3", {});
    Desk result;
    result.camera = source->description().camera;
    DepthPreparation preparation;
    RgbdFrame frame;
    while (source->read(frame) == ReadStatus::kFrame) {
      Frame& kept = *result.frames.emplace_back(std::make_unique<Frame>());
      kept.color = frame.color.clone();
      kept.depth_m = frame.depth_m.clone();
      kept.T_WC = frame.T_WC.value();
      preparation.prepare(kept.depth_m, result.camera, kept.depth);
      Perceiver().perceive(kept.color, &kept.depth, kept.seen);
    }
    return result;
  }();
  return read;
}

/// Runs the stage over the frames until it knows them all, then counts what it allocates for each of them anew.
std::size_t mostAllocations(const std::function<void(const Frame&)>& stage) {
  constexpr int kWarmLaps = 2;
  for (int lap = 0; lap < kWarmLaps; ++lap) {
    for (const auto& frame : desk().frames) stage(*frame);
  }
  std::size_t most = 0;
  for (const auto& frame : desk().frames) {
    const std::size_t before = test::allocationsSoFar();
    stage(*frame);
    most = std::max(most, test::allocationsSoFar() - before);
  }
  return most;
}

TEST(Allocations, AreCounted) {
  const std::size_t before = test::allocationsSoFar();
  std::vector<int> fresh(100);
  const cv::Mat1f image(10, 10);
  ASSERT_FALSE(fresh.empty() || image.empty());
  EXPECT_GE(test::allocationsSoFar() - before, 2u);
}

TEST(Allocations, PreparingDepthTakesNone) {
  DepthPreparation preparation;
  DepthMaps maps;
  EXPECT_EQ(mostAllocations([&](const Frame& f) { preparation.prepare(f.depth_m, desk().camera, maps); }), 0u);
}

TEST(Allocations, SaliencyTakesNone) {
  SaliencyModel saliency;
  EXPECT_EQ(mostAllocations([&](const Frame& f) { saliency.compute(f.color); }), 0u);
}

TEST(Allocations, ColourSegmentsTakeNone) {
  ColorSegmenter segmenter;
  EXPECT_EQ(mostAllocations([&](const Frame& f) { segmenter.segment(f.color); }), 0u);
}

TEST(Allocations, SurfaceSegmentsTakeNone) {
  SurfaceSegmenter segmenter;
  EXPECT_EQ(mostAllocations([&](const Frame& f) { segmenter.segment(f.depth); }), 0u);
}

TEST(Allocations, SegmentTablesTakeNone) {
  SegmentTable color, surface;
  EXPECT_EQ(mostAllocations([&](const Frame& f) {
              SegmentTable::build(color, f.seen.color, surface, f.seen.surface, f.seen.saliency, f.color, &f.depth);
            }),
            0u);
}

/// What proposals and ranking may take: the lists that they hand over and a few of a frame's size. There are some
/// hundred candidates in the desk's frames, none of which takes memory of its own.
constexpr std::size_t kListsOfAFrame = 40;

TEST(Allocations, ProposingTakesNoneForACandidate) {
  Proposer proposer;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  const auto propose = [&](const Frame& f) { fewest = std::min(fewest, proposer.propose(f.seen).size()); };
  EXPECT_LE(mostAllocations(propose), kListsOfAFrame);
  EXPECT_GT(fewest, 5 * kListsOfAFrame);
}

TEST(Allocations, RankingTakesNoneForACandidate) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  Proposer proposer;
  Ranker ranker;
  std::size_t most = 0;
  for (int lap = 0; lap < 3; ++lap) {
    for (const auto& frame : desk().frames) {
      Candidates pool = proposer.propose(frame->seen);
      const std::size_t before = test::allocationsSoFar();
      const Candidates ranked = ranker.rank(std::move(pool), frame->seen);
      if (lap > 1) most = std::max(most, test::allocationsSoFar() - before);
    }
  }
  EXPECT_LE(most, kListsOfAFrame);
}

TEST(Allocations, TheSurfaceVolumeAndItsViewTakeNone) {
  SurfaceVolume volume;
  ModelView view;
  const PinholeCamera camera = desk().camera.reducedBy(2);
  EXPECT_EQ(mostAllocations([&](const Frame& f) { volume.integrate(f.depth, f.T_WC); }), 0u);
  EXPECT_EQ(mostAllocations([&](const Frame& f) { volume.rayCast(camera, f.T_WC, view); }), 0u);
}

TEST(Allocations, TrackingTakesNone) {
  SurfaceVolume volume;
  for (const auto& frame : desk().frames) volume.integrate(frame->depth, frame->T_WC);
  ModelView view;
  volume.rayCast(desk().camera.reducedBy(2), desk().frames[0]->T_WC, view);
  Tracker tracker;
  PhotometricReference reference;
  IntensityPyramid intensity;
  EXPECT_EQ(mostAllocations([&](const Frame& f) { intensity.build(f.color, desk().camera); }), 0u);
  EXPECT_EQ(mostAllocations([&](const Frame& f) { reference.take(f.depth, intensity, f.T_WC); }), 0u);
  const TrackedColor color{intensity, reference};
  EXPECT_EQ(mostAllocations([&](const Frame& f) { (void)tracker.track(f.depth, view, f.T_WC, &color); }), 0u);
}

TEST(Allocations, TheMapAndItsViewTakeNone) {
  IorMap map;
  Renderer renderer;
  EXPECT_EQ(mostAllocations([&](const Frame& f) { (void)map.integrate(f.depth, f.color, f.T_WC); }), 0u);
  EXPECT_EQ(mostAllocations([&](const Frame& f) { (void)renderer.renderIor(map.view(), desk().camera, f.T_WC); }), 0u);
}

TEST(Allocations, AttendingWhatMasksShowTakesNone) {
  IorMapConfig config;
  config.ior.ior_limit = 1000;  // the list of flags that go on is handed over, and none may
  IorMap map(config);
  for (const auto& frame : desk().frames) map.integrate(frame->depth, frame->color, frame->T_WC);
  std::vector<IorView> views;
  Renderer renderer;
  for (const auto& frame : desk().frames) {
    views.push_back(cloneView(renderer.renderIor(map.view(), desk().camera, frame->T_WC)));
  }
  BackProjector projector;
  std::vector<LeafKey> of_mask, of_all;
  std::size_t next = 0;
  EXPECT_EQ(mostAllocations([&](const Frame&) {
              projector.begin(views[next++ % views.size()]);
              for (int mask = 0; mask < 3; ++mask) {
                projector.beginMask();
                for (int v = 100 * mask; v < 100 * mask + 150; ++v) projector.addRun(v, 50, 300);
                projector.keys(of_mask);
              }
              projector.allKeys(of_all);
              EXPECT_GT(map.attend(of_all).attended, 1000);
            }),
            0u);
}

}  // namespace
}  // namespace saccade
