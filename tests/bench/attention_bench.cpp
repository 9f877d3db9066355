// Saliency and salient blobs, beside VOCUS2 written down with OpenCV's filters.

#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/kitchen_frames.hpp"
#include "saccade/attention/saliency.hpp"
#include "saccade/attention/salient_blobs.hpp"
#include "saccade/discovery/perceiver.hpp"
#include "support/saliency_by_definition.hpp"

namespace saccade::bench {
namespace {

void saliency(benchmark::State& state) {
  SaliencyModel model;
  const std::vector<RgbdFrame>& frames = kitchenFrames().frames;
  model.compute(frames[0].color);  // reserves its memory
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(model.compute(frames[i++ % frames.size()].color).data);
  }
}
BENCHMARK(saliency)->Unit(benchmark::kMillisecond);

void saliencyOfVocus2(benchmark::State& state) {
  const std::vector<RgbdFrame>& frames = kitchenFrames().frames;
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(test::saliencyByDefinition(frames[i++ % frames.size()].color, SaliencyConfig()).data);
  }
}
BENCHMARK(saliencyOfVocus2)->Unit(benchmark::kMillisecond);

/// Maxima and blobs of ready saliency maps, from as many maxima as a perceived frame has by default.
void salientBlobs(benchmark::State& state) {
  SaliencyModel model;
  std::vector<cv::Mat1f> maps;
  for (const RgbdFrame& frame : kitchenFrames().frames) maps.push_back(model.compute(frame.color).clone());
  const auto most = static_cast<std::size_t>(PerceptionConfig().max_maxima);
  BlobGrower grower;
  std::size_t i = 0;
  for (auto _ : state) {
    const cv::Mat1f& map = maps[i++ % maps.size()];
    std::vector<SaliencyMaximum> maxima = findLocalMaxima(map);
    if (maxima.size() > most) maxima.resize(most);
    benchmark::DoNotOptimize(grower.grow(map, maxima).data());
  }
}
BENCHMARK(salientBlobs)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace saccade::bench
