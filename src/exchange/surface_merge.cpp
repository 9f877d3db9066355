#include "saccade/exchange/surface_merge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;

struct Sample {
  double distance_m = 0.0;
  double weight = 0.0;  ///< in the brick's own units
};

int floorDivided(int value, int by) {
  return value >= 0 ? value / by : -((by - 1 - value) / by);
}

/// Bricks of a volume by position.
class BrickIndex {
 public:
  explicit BrickIndex(const SurfaceVolume& volume) : volume_(volume) {
    for (std::size_t i = 0; i < volume.bricks().size(); ++i) index_[volume.bricks()[i]] = i;
  }

  [[nodiscard]] const SurfaceBrick* find(const BrickPosition& position) const {
    const auto found = index_.find(position);
    return found == index_.end() ? nullptr : &volume_.brick(found->second);
  }

  /// The sample (x, y, z) of the grid, if it is known.
  [[nodiscard]] std::optional<Sample> sample(const Eigen::Vector3i& at) const {
    const BrickPosition position{floorDivided(at.x(), kSide), floorDivided(at.y(), kSide), floorDivided(at.z(), kSide)};
    const SurfaceBrick* brick = find(position);
    if (brick == nullptr) return std::nullopt;
    const int i = at.x() - kSide * position.x, j = at.y() - kSide * position.y, k = at.z() - kSide * position.z;
    const auto index = static_cast<std::size_t>(i + kSide * (j + kSide * k));
    if (brick->weight[index] == 0) return std::nullopt;
    const double band_m = volume_.config().band_cells * volume_.config().cell_m;
    return Sample{brick->distance[index] * band_m / SurfaceBrick::kDistanceScale,
                  static_cast<double>(brick->weight[index])};
  }

 private:
  const SurfaceVolume& volume_;
  std::map<BrickPosition, std::size_t> index_;
};

/// What `from` knows at a point: interpolated between the eight samples around, or the nearest one if the point is it.
std::optional<Sample> sampleAt(const SurfaceVolume& from, const BrickIndex& index, const Eigen::Vector3d& p_F) {
  const Eigen::Vector3d cells = p_F / from.config().cell_m;
  const Eigen::Vector3d nearest = cells.array().round();
  const std::optional<Sample> sample = index.sample(nearest.cast<int>());
  constexpr double kOnSample = 1e-6;  // cells
  if (!sample || (cells - nearest).cwiseAbs().maxCoeff() < kOnSample) return sample;
  const std::optional<double> distance_m = from.distanceAt(p_F);
  return distance_m ? std::optional(Sample{*distance_m, sample->weight}) : std::nullopt;
}

/// Positions of the bricks of `into` that a brick of `from` may reach.
std::set<BrickPosition> reachedBricks(const SurfaceVolume& from, const Pose& T_IF, const SurfaceVolume& into) {
  std::set<BrickPosition> reached;
  const double from_edge_m = kSide * from.config().cell_m, into_edge_m = kSide * into.config().cell_m;
  for (const BrickPosition& brick : from.bricks()) {
    const Eigen::Vector3d centre =
        T_IF * ((Eigen::Vector3d(brick.x, brick.y, brick.z) + Eigen::Vector3d::Constant(0.5)) * from_edge_m);
    const Eigen::Vector3d reach = T_IF.linear().cwiseAbs() * Eigen::Vector3d::Constant(0.5 * from_edge_m);
    const Eigen::Vector3i low = ((centre - reach) / into_edge_m).array().floor().cast<int>();
    const Eigen::Vector3i high = ((centre + reach) / into_edge_m).array().floor().cast<int>();
    for (int x = low.x(); x <= high.x(); ++x) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int z = low.z(); z <= high.z(); ++z) reached.insert({x, y, z});
      }
    }
  }
  return reached;
}

SurfaceBrick unknownBrick() {
  SurfaceBrick brick;
  brick.distance.fill(SurfaceBrick::kUnknownDistance);
  brick.weight.fill(0);
  return brick;
}

void blend(const Sample& sample, const SurfaceVolumeConfig& config, std::int16_t& distance, std::uint16_t& weight) {
  const double band_m = config.band_cells * config.cell_m;
  const double scaled = std::clamp(sample.distance_m / band_m, -1.0, 1.0) * SurfaceBrick::kDistanceScale;
  const double before = weight;
  const double mean = before > 0.0 ? (distance * before + scaled * sample.weight) / (before + sample.weight) : scaled;
  const double cap = std::min(65535.0, config.weight_cap * SurfaceBrick::kWeightScale);
  distance = static_cast<std::int16_t>(std::lround(mean));
  weight = static_cast<std::uint16_t>(std::min(cap, before + sample.weight));
}

}  // namespace

void mergeSurface(const SurfaceVolume& from, const Pose& T_IF, SurfaceVolume& into) {
  const BrickIndex of_from(from), of_into(into);
  const Pose T_FI = T_IF.inverse();
  std::vector<std::pair<BrickPosition, SurfaceBrick>> merged;
  for (const BrickPosition& position : reachedBricks(from, T_IF, into)) {
    const SurfaceBrick* old = of_into.find(position);
    SurfaceBrick brick = old != nullptr ? *old : unknownBrick();
    bool touched = false;
    for (int sample = 0; sample < SurfaceBrick::kSamples; ++sample) {
      const Eigen::Vector3d at(kSide * position.x + sample % kSide, kSide * position.y + sample / kSide % kSide,
                               kSide * position.z + sample / (kSide * kSide));
      const auto found = sampleAt(from, of_from, T_FI * (at * into.config().cell_m));
      if (!found) continue;
      const auto i = static_cast<std::size_t>(sample);
      blend(*found, into.config(), brick.distance[i], brick.weight[i]);
      touched = true;
    }
    if (touched) merged.emplace_back(position, brick);
  }
  for (const auto& [position, brick] : merged) into.importBrick(position, brick);
}

}  // namespace saccade
