#include <vector>

#include <benchmark/benchmark.h>
#include <octomap/OcTree.h>

#include "bench/prepared_frames.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/ior_octree.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/rendering/renderer.hpp"

namespace saccade::bench {
namespace {

void prepareDepth(benchmark::State& state) {
  const KitchenFrames& kitchen = kitchenFrames();
  DepthPreparation preparation;
  DepthMaps maps;
  std::size_t i = 0;
  for (auto _ : state) preparation.prepare(kitchen.frames[i++ % kitchen.frames.size()].depth_m, kitchen.camera, maps);
}
BENCHMARK(prepareDepth)->Unit(benchmark::kMillisecond);

/// Frames come round again and again: after the first lap the map is that of a camera that looks at known places.
void integrateSurface(benchmark::State& state) {
  SurfaceVolume volume = surfaceOfKitchen();
  const auto& frames = preparedFrames();
  std::size_t i = 0;
  for (auto _ : state) {
    const PreparedFrame& frame = frames[i++ % frames.size()];
    volume.integrate(frame.depth, frame.T_WC);
  }
}
BENCHMARK(integrateSurface)->Unit(benchmark::kMillisecond);

void integrateMap(benchmark::State& state) {
  IorMap map;
  const auto& frames = preparedFrames();
  for (const PreparedFrame& frame : frames) map.integrate(frame.depth, frame.color, frame.T_WC);
  std::size_t i = 0;
  for (auto _ : state) {
    const PreparedFrame& frame = frames[i++ % frames.size()];
    benchmark::DoNotOptimize(map.integrate(frame.depth, frame.color, frame.T_WC));
  }
  state.counters["leaves"] = static_cast<double>(map.leafCount());
}
BENCHMARK(integrateMap)->Unit(benchmark::kMillisecond);

/// OctoMap's fastest correct way to add a frame: one ray for each leaf that holds points.
void integrateMapByOctoMap(benchmark::State& state) {
  const IorMapConfig config;
  octomap::OcTree tree(config.leaf_size_m);
  tree.setProbHit(config.hit_probability);
  tree.setProbMiss(config.miss_probability);
  tree.setClampingThresMin(config.lowest_probability);
  tree.setClampingThresMax(config.highest_probability);
  const auto& frames = preparedFrames();
  std::size_t i = 0;
  for (auto _ : state) {
    const PreparedFrame& frame = frames[i++ % frames.size()];
    state.PauseTiming();
    octomap::Pointcloud cloud;
    for (int v = 0; v < frame.depth.depth_m.rows; ++v) {
      for (int u = 0; u < frame.depth.depth_m.cols; ++u) {
        const auto z = static_cast<double>(frame.depth.depth_m(v, u));
        if (z <= 0.0) continue;
        const Eigen::Vector3f p = (frame.T_WC * frame.depth.camera.unproject(u, v, z)).cast<float>();
        cloud.push_back(p.x(), p.y(), p.z());
      }
    }
    const Eigen::Vector3f t = frame.T_WC.translation().cast<float>();
    state.ResumeTiming();
    tree.insertPointCloud(cloud, octomap::point3d(t.x(), t.y(), t.z()), -1.0, false, true);
  }
}
BENCHMARK(integrateMapByOctoMap)->Unit(benchmark::kMillisecond)->Iterations(3);

/// Attention to what a quarter of the image shows, which closes the tick.
void attendLeaves(benchmark::State& state) {
  IorMap map = mapOfKitchen();
  Renderer renderer;
  std::vector<std::vector<LeafKey>> keys;
  for (const PreparedFrame& frame : preparedFrames()) {
    const IorView& view = renderer.renderIor(map.view(), frame.depth.camera, frame.T_WC);
    auto& seen = keys.emplace_back();
    for (std::size_t leaf = 0; leaf < view.leaves.size(); leaf += 4) seen.push_back(view.leaves[leaf].key);
  }
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(map.attend(keys[i++ % keys.size()]));
}
BENCHMARK(attendLeaves)->Unit(benchmark::kMillisecond);

/// The paper's rule to the letter ("3D IOR map update"): every occupied leaf that is not attended decays at every
/// frame. Ours stores when a leaf will be forgotten instead, and does nothing.
void decayByTheLetter(benchmark::State& state) {
  octomap::OcTree tree(0.01);
  struct Memory {
    float weight = 100.0F;
    bool flag = true;
  };
  std::vector<Memory> memory;
  mapOfKitchen().forEachLeaf([&](const MapLeaf& leaf) {
    if (!leaf.occupied) return;
    const auto& corner = leaf.key.corner;
    tree.setNodeValue(octomap::OcTreeKey(corner.x, corner.y, corner.z), leaf.log_odds, true);
    memory.emplace_back();
  });
  tree.updateInnerOccupancy();
  for (auto _ : state) {
    std::size_t i = 0;
    for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs() && i < memory.size(); ++leaf, ++i) {
      if (!tree.isNodeOccupied(*leaf)) continue;
      Memory& m = memory[i];
      m.weight = std::max(0.0F, m.weight - 1.0F);
      if (m.weight == 0.0F) m.flag = false;
    }
    benchmark::ClobberMemory();
  }
  state.counters["occupied leaves"] = static_cast<double>(memory.size());
}
BENCHMARK(decayByTheLetter)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace saccade::bench
