// The whole pipeline as `saccade explore INPUT -o SESSION` runs it: decoding, stages, keyframes and checkpoints.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <sys/resource.h>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "saccade/pipeline/explorer.hpp"
#include "saccade/session/session_sink.hpp"
#include "saccade/sources/read_ahead.hpp"
#include "support/temporary_folder.hpp"

namespace saccade::bench {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double coreSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peakMemoryMiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// The value that a share of the sorted values does not exceed.
double percentile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Runs the sequence once, since the frames' order matters; the time is that from frame to frame.
void wholeFrame(benchmark::State& state) {
  const std::string folder = (std::filesystem::path(SACCADE_TEST_DATA_DIR) / "kitchen").string();
  const test::TemporaryFolder session;
  std::vector<double> frame_ms;
  for (auto _ : state) {
    ReadAhead source(openSource(folder, FrameRange::parse("0:" + std::to_string(state.range(0)))));
    const SourceDescription& description = source.description();
    Explorer explorer(ExplorerConfig(), description.camera);
    RunRecord run;
    run.input = folder;
    run.input_kind = description.kind;
    SessionSink sink(std::make_unique<SessionWriter>(session / "s.saccade", WhenSessionExists::kRefuse), explorer,
                     CandidateOutliner(DistortedPixels(description.camera, description.color_camera)), run);
    RgbdFrame frame, next;
    const double core_seconds = coreSeconds();
    const auto begin = Clock::now();
    auto frame_begin = begin;
    for (ReadStatus status = source.read(frame); status == ReadStatus::kFrame; std::swap(frame, next)) {
      status = source.read(next);
      sink.accept(frame, explorer.process(frame, status == ReadStatus::kFrame ? &next : nullptr));
      frame_ms.push_back(1e3 * secondsSince(frame_begin));
      frame_begin = Clock::now();
    }
    const auto frames = static_cast<double>(frame_ms.size());
    state.SetIterationTime(secondsSince(begin) / frames);
    state.counters["core_ms"] = 1e3 * (coreSeconds() - core_seconds) / frames;
    sink.finish();
  }
  std::sort(frame_ms.begin(), frame_ms.end());
  state.counters["p50_ms"] = percentile(frame_ms, 0.50);
  state.counters["p95_ms"] = percentile(frame_ms, 0.95);
  state.counters["p99_ms"] = percentile(frame_ms, 0.99);
  state.counters["peak_MiB"] = peakMemoryMiB();
}
BENCHMARK(wholeFrame)->Arg(500)->ArgName("frames")->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace saccade::bench
