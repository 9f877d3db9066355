// What a frame costs while the map around it grows: the same places of the kitchen are seen again and again, while
// copies of them far beyond the camera's range make the map larger.

#include <cstddef>
#include <cstdint>
#include <unistd.h>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/prepared_frames.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/rendering/renderer.hpp"

namespace saccade::bench {
namespace {

constexpr std::size_t kFramesAtHome = 2;
/// Copies stand this far apart, beyond what two cameras see (4 m each), in layers of kCopiesAlongEdge squared.
constexpr double kSpacing_m = 9.0;
constexpr std::int64_t kCopiesAlongEdge = 60;
/// Memory that must be left for others, and what a node takes with its share of half-empty families.
constexpr double kMemoryLeft = 2e9, kBytesPerNode = 60.0;

/// A map that only ever grows, so that each size costs what lies between it and the one before.
class GrowingMap {
 public:
  GrowingMap() {
    for (std::size_t i = 0; i < kFramesAtHome; ++i) integrate(i, Eigen::Vector3d::Zero());
  }

  IorMap& map() { return map_; }

  /// Leaves when it last grew.
  [[nodiscard]] std::size_t leaves() const { return leaves_; }

  /// Adds copies until there are about `leaves`; false if there is no memory for them.
  bool growTo(std::size_t leaves) {
    const std::size_t nodes = leaves / 7 * 8;  // counting leaves would be a walk through all of them
    while (map_.nodeCount() < nodes) {
      const double more = static_cast<double>(nodes - map_.nodeCount()) * kBytesPerNode;
      const double available =
          static_cast<double>(sysconf(_SC_AVPHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
      if (more + kMemoryLeft > available) return false;
      const std::int64_t place = ++copies_;
      const std::int64_t column = place % kCopiesAlongEdge, row = place / kCopiesAlongEdge % kCopiesAlongEdge,
                         layer = 1 + place / kCopiesAlongEdge / kCopiesAlongEdge;
      const Eigen::Vector3d offset(static_cast<double>(column - kCopiesAlongEdge / 2), static_cast<double>(layer),
                                   static_cast<double>(row - kCopiesAlongEdge / 2));
      integrate(static_cast<std::size_t>(place) % preparedFrames().size(), kSpacing_m * offset);
      leaves_ = 0;
    }
    if (leaves_ == 0) leaves_ = map_.leafCount();
    return true;
  }

 private:
  void integrate(std::size_t i, const Eigen::Vector3d& offset_m) {
    const PreparedFrame& frame = preparedFrames()[i];
    const Pose T_WC = Eigen::Translation3d(offset_m) * frame.T_WC;
    (void)map_.integrate(frame.depth, frame.color, T_WC);
  }

  IorMap map_;
  std::int64_t copies_ = 0;
  std::size_t leaves_ = 0;
};

/// The map with about as many leaves as the benchmark asks for; null (and the benchmark is skipped) if that is more
/// than memory holds.
IorMap* mapOfSize(benchmark::State& state) {
  static GrowingMap growing;
  if (!growing.growTo(static_cast<std::size_t>(state.range(0)))) {
    state.SkipWithError("not enough memory");
    return nullptr;
  }
  const auto leaves = static_cast<double>(growing.leaves());
  state.counters["leaves"] = leaves;
  state.counters["bytes_per_leaf"] = static_cast<double>(growing.map().memoryBytes()) / leaves;
  return &growing.map();
}

void scaleIntegrate(benchmark::State& state) {
  IorMap* map = mapOfSize(state);
  if (map == nullptr) return;
  std::size_t i = 0;
  for (auto _ : state) {
    const PreparedFrame& frame = preparedFrames()[i++ % kFramesAtHome];
    benchmark::DoNotOptimize(map->integrate(frame.depth, frame.color, frame.T_WC));
  }
}

void scaleRender(benchmark::State& state) {
  IorMap* map = mapOfSize(state);
  if (map == nullptr) return;
  Renderer renderer;
  std::size_t i = 0;
  for (auto _ : state) {
    const PreparedFrame& frame = preparedFrames()[i++ % kFramesAtHome];
    benchmark::DoNotOptimize(&renderer.renderIor(map->view(), frame.depth.camera, frame.T_WC));
  }
}

/// A quarter of the leaves that are seen, which closes the tick.
void scaleAttend(benchmark::State& state) {
  IorMap* map = mapOfSize(state);
  if (map == nullptr) return;
  Renderer renderer;
  const PreparedFrame& frame = preparedFrames()[0];
  const IorView& view = renderer.renderIor(map->view(), frame.depth.camera, frame.T_WC);
  std::vector<LeafKey> keys;
  for (std::size_t leaf = 0; leaf < view.leaves.size(); leaf += 4) keys.push_back(view.leaves[leaf].key);
  for (auto _ : state) benchmark::DoNotOptimize(map->attend(keys));
}

/// What the frame thread does for a checkpoint after one frame: it copies the tiles that changed.
void scaleCheckpoint(benchmark::State& state) {
  IorMap* map = mapOfSize(state);
  if (map == nullptr) return;
  (void)takeTileChanges(*map);
  std::vector<std::byte> bytes;
  std::size_t i = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const PreparedFrame& frame = preparedFrames()[i++ % kFramesAtHome];
    (void)map->integrate(frame.depth, frame.color, frame.T_WC);
    bytes.clear();
    state.ResumeTiming();
    for (const TileChange& tile : takeTileChanges(*map)) {
      if (tile.changed) appendTile(tile.node, bytes);
    }
  }
}

void registerScale() {
  for (const std::int64_t leaves : {100'000, 1'000'000, 10'000'000, 100'000'000}) {
    const auto add = [leaves](const char* name, void (*run)(benchmark::State&)) {
      benchmark::RegisterBenchmark(name, run)->Arg(leaves)->Iterations(30)->Repetitions(3)->Unit(
          benchmark::kMillisecond);
    };
    add("scaleIntegrate", scaleIntegrate);
    add("scaleRender", scaleRender);
    add("scaleAttend", scaleAttend);
    add("scaleCheckpoint", scaleCheckpoint);
  }
}

/// By hand, since the order matters: all of one size before the next.
[[maybe_unused]] const bool is_registered = (registerScale(), true);

}  // namespace
}  // namespace saccade::bench
