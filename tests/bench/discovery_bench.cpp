// Candidates: tables of the segments' sums, proposals, features, the SVM and the ranking, beside proposals of OpenCV.

#include <cstddef>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "bench/perceived_frames.hpp"
#include "saccade/discovery/inhibition.hpp"
#include "saccade/discovery/proposals.hpp"
#include "saccade/discovery/ranker.hpp"
#include "saccade/evaluation/rival_proposals.hpp"

namespace saccade::bench {
namespace {

/// Both tables, their overlap and the supporting planes.
/// On one core: idle ones would help.
void segmentTables(benchmark::State& state) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<PerceivedFrame>& frames = perceivedFrames();
  std::size_t i = 0;
  for (auto _ : state) {
    PerceivedFrame& frame = frames[i++ % frames.size()];
    frame.seen.makeTables(frame.color, &frame.depth);
  }
}
BENCHMARK(segmentTables)->Unit(benchmark::kMillisecond);

void propose(benchmark::State& state) {
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  Proposer proposer;
  std::size_t i = 0;
  double candidates = 0.0;
  for (auto _ : state) {
    const Candidates pool = proposer.propose(frames[i++ % frames.size()].seen);
    candidates += static_cast<double>(pool.size());
  }
  state.counters["candidates"] = benchmark::Counter(candidates, benchmark::Counter::kAvgIterations);
}
BENCHMARK(propose)->Unit(benchmark::kMillisecond);

/// Copies of the pools are made before the clock starts: all of these stages write into their candidates.
std::vector<Candidates> pools() {
  std::vector<Candidates> pools;
  for (const PerceivedFrame& frame : perceivedFrames()) pools.push_back(proposeCandidates(frame.seen, {}));
  return pools;
}

/// Against a 2D IOR map whose left third is white.
void inhibit(benchmark::State& state) {
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  const std::vector<Candidates> all = pools();
  cv::Mat1b inhibited(frames[0].seen.imageSize(), std::uint8_t{0});
  inhibited.colRange(0, inhibited.cols / 3).setTo(255);
  std::size_t i = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const std::size_t frame = i++ % frames.size();
    Candidates pool = all[frame];
    state.ResumeTiming();
    benchmark::DoNotOptimize(withoutInhibited(std::move(pool), frames[frame].seen, inhibited, {}));
  }
}
BENCHMARK(inhibit)->Unit(benchmark::kMillisecond);

void measureFeatures(benchmark::State& state) {
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  std::vector<Candidates> all = pools();
  CandidateMeasurer measurer;
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t frame = i++ % frames.size();
    measurer.measure(all[frame], frames[frame].seen);
  }
}
BENCHMARK(measureFeatures)->Unit(benchmark::kMillisecond);

void scoreCandidates(benchmark::State& state) {
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  std::vector<Candidates> all = pools();
  CandidateMeasurer measurer;
  for (std::size_t i = 0; i < all.size(); ++i) measurer.measure(all[i], frames[i].seen);
  const RankerModel& model = RankerModel::builtIn(FeatureSet::kExtended);
  std::size_t i = 0;
  for (auto _ : state) model.score(all[i++ % all.size()]);
}
BENCHMARK(scoreCandidates)->Unit(benchmark::kMillisecond);

/// Features, scores, duplicates and suppression, on one core: idle ones would help.
void rankCandidates(benchmark::State& state) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  const std::vector<Candidates> all = pools();
  Ranker ranker;
  std::size_t i = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const std::size_t frame = i++ % frames.size();
    Candidates pool = all[frame];
    state.ResumeTiming();
    benchmark::DoNotOptimize(ranker.rank(std::move(pool), frames[frame].seen));
  }
}
BENCHMARK(rankCandidates)->Unit(benchmark::kMillisecond);

/// Everything the attention branch does with a frame before it proposes, on one core: idle ones would help.
void perceiveFrame(benchmark::State& state) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  Perceiver perceiver;
  Perception seen;
  std::size_t i = 0;
  for (auto _ : state) {
    const PerceivedFrame& frame = frames[i++ % frames.size()];
    perceiver.perceive(frame.color, &frame.depth, seen);
  }
}
BENCHMARK(perceiveFrame)->Unit(benchmark::kMillisecond);

void proposeBySelectiveSearch(benchmark::State& state) {
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(selectiveSearchBoxes(frames[i++ % frames.size()].color).size());
}
BENCHMARK(proposeBySelectiveSearch)->Unit(benchmark::kMillisecond)->Iterations(2);

void proposeByEdgeBoxes(benchmark::State& state) {
  const std::vector<PerceivedFrame>& frames = perceivedFrames();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(edgeBoxes(frames[i++ % frames.size()].color).size());
}
BENCHMARK(proposeByEdgeBoxes)->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
}  // namespace saccade::bench
