#include <benchmark/benchmark.h>
#include <octomap/OcTree.h>

#include "bench/prepared_frames.hpp"
#include "saccade/rendering/depth_completion.hpp"
#include "saccade/rendering/renderer.hpp"

namespace saccade::bench {
namespace {

/// The surface volume's view: with 1 of the frame's full resolution, with 2 as tracking asks for it.
void modelView(benchmark::State& state) {
  const SurfaceVolume volume = surfaceOfKitchen();
  const PinholeCamera camera = kitchenFrames().camera.reducedBy(static_cast<int>(state.range(0)));
  ModelView view;
  std::size_t i = 0;
  const auto& frames = preparedFrames();
  for (auto _ : state) volume.rayCast(camera, frames[i++ % frames.size()].T_WC, view);
}
BENCHMARK(modelView)->Arg(1)->Arg(2)->ArgName("reduction")->Unit(benchmark::kMillisecond);

void completeDepth(benchmark::State& state) {
  const SurfaceVolume volume = surfaceOfKitchen();
  DepthCompletion completion;
  DepthMaps completed;
  std::size_t i = 0;
  const auto& frames = preparedFrames();
  for (auto _ : state) {
    const PreparedFrame& frame = frames[i++ % frames.size()];
    benchmark::DoNotOptimize(completion.complete(frame.depth, volume, frame.T_WC, completed));
  }
}
BENCHMARK(completeDepth)->Unit(benchmark::kMillisecond);

void iorView(benchmark::State& state) {
  const IorMap map = mapOfKitchen();
  Renderer renderer;
  std::size_t i = 0;
  const auto& frames = preparedFrames();
  for (auto _ : state) {
    benchmark::DoNotOptimize(&renderer.renderIor(map.view(), kitchenFrames().camera, frames[i++ % frames.size()].T_WC));
  }
}
BENCHMARK(iorView)->Unit(benchmark::kMillisecond);

/// One in 64 of a frame's rays; the counter says what all of them cost.
void castRayByOctoMap(benchmark::State& state) {
  constexpr int kStride = 8;
  const IorMapConfig config;
  octomap::OcTree tree(config.leaf_size_m);
  mapOfKitchen().forEachLeaf([&](const MapLeaf& leaf) {
    const int edge = 1 << (MapTree::kDepth - leaf.key.depth);
    for (int i = 0; i < edge * edge * edge; ++i) {
      const octomap::OcTreeKey key(static_cast<std::uint16_t>(leaf.key.corner.x + i % edge),
                                   static_cast<std::uint16_t>(leaf.key.corner.y + i / edge % edge),
                                   static_cast<std::uint16_t>(leaf.key.corner.z + i / edge / edge));
      tree.setNodeValue(key, leaf.log_odds, true);
    }
  });
  tree.updateInnerOccupancy();
  tree.prune();
  const PinholeCamera& camera = kitchenFrames().camera;
  const auto& frames = preparedFrames();
  std::size_t i = 0;
  for (auto _ : state) {
    const Pose& T_WC = frames[i++ % frames.size()].T_WC;
    const Eigen::Vector3f origin = T_WC.translation().cast<float>();
    for (int v = kStride / 2; v < camera.height; v += kStride) {
      for (int u = kStride / 2; u < camera.width; u += kStride) {
        const Eigen::Vector3f ray = (T_WC.linear() * camera.unproject(u, v, 1.0)).cast<float>();
        octomap::point3d end;
        benchmark::DoNotOptimize(tree.castRay({origin.x(), origin.y(), origin.z()}, {ray.x(), ray.y(), ray.z()}, end,
                                              true, config.max_range_m));
      }
    }
  }
  state.counters["whole frames a second"] =
      benchmark::Counter(1.0 / (kStride * kStride), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(castRayByOctoMap)->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
}  // namespace saccade::bench
