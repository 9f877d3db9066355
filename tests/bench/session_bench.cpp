#include <filesystem>

#include <benchmark/benchmark.h>
#include <octomap/AbstractOcTree.h>

#include "bench/prepared_frames.hpp"
#include "saccade/core/config_file.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/ior_octree.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_writer.hpp"
#include "session/map_blobs.hpp"
#include "support/temporary_folder.hpp"

namespace saccade::bench {
namespace {

const IorMap& kitchenMap() {
  static const IorMap map = [] {
    IorMap built;
    for (const PreparedFrame& frame : preparedFrames()) built.integrate(frame.depth, frame.color, frame.T_WC);
    return built;
  }();
  return map;
}

void saveSession(const IorMap& map, const std::filesystem::path& path) {
  SessionWriter writer(path, WhenSessionExists::kReplace);
  for (const MapTile& tile : encodeTiles(map)) {
    writer.putBlob(BlobTable::kTiles, {tileKey(tile.root), 1, bytesOf(tile.data)});
  }
  SessionMetadata metadata;
  ExplorerConfig config;
  metadata.config_yaml = printConfig(describing(config), false);
  metadata.leaf_size_m = map.config().leaf_size_m;
  writer.finish(metadata);
}

void countMap(benchmark::State& state, const std::filesystem::path& path) {
  state.counters["leaves"] = static_cast<double>(kitchenMap().leafCount());
  state.counters["MB"] = static_cast<double>(std::filesystem::file_size(path)) / 1e6;
}

/// The map alone, compressed, checked and synced to the disk.
void saveMapAsSession(benchmark::State& state) {
  const test::TemporaryFolder folder;
  const IorMap& map = kitchenMap();
  for (auto _ : state) saveSession(map, folder / "s.saccade");
  countMap(state, folder / "s.saccade");
}
BENCHMARK(saveMapAsSession)->Unit(benchmark::kMillisecond);

void loadMapFromSession(benchmark::State& state) {
  const test::TemporaryFolder folder;
  saveSession(kitchenMap(), folder / "s.saccade");
  for (auto _ : state) benchmark::DoNotOptimize(loadMap(SessionReader(folder / "s.saccade")));
}
BENCHMARK(loadMapFromSession)->Unit(benchmark::kMillisecond);

/// OctoMap's own format of the same tree: neither compressed, checked nor synced.
void saveMapByOctoMap(benchmark::State& state) {
  const test::TemporaryFolder folder;
  const IorOcTree& tree = kitchenMap().tree();
  for (auto _ : state) tree.write(folder / "m.ot");
  countMap(state, folder / "m.ot");
}
BENCHMARK(saveMapByOctoMap)->Unit(benchmark::kMillisecond);

void loadMapByOctoMap(benchmark::State& state) {
  const test::TemporaryFolder folder;
  IorOcTree::ensureLinking();
  kitchenMap().tree().write(folder / "m.ot");
  for (auto _ : state) {
    const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(folder / "m.ot"));
    benchmark::DoNotOptimize(tree->size());
  }
}
BENCHMARK(loadMapByOctoMap)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace saccade::bench
