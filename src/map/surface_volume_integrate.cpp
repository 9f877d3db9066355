#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/lanes.hpp"
#include "map/surface_volume_scratch.hpp"
#include "saccade/core/multiversion.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;
constexpr int kSamples = SurfaceBrick::kSamples;

// Eight samples as a brick stores them.
using Distances = std::int16_t __attribute__((vector_size(16)));
using Weights = std::uint16_t __attribute__((vector_size(16)));

struct Projection {
  const float* depth;
  int width, height;
  float fx, fy, cx, cy;
  float band;         // metres
  float near_square;  // square metres
  float weight_cap;   // in 1 / kWeightScale observations
};

// Updates the brick whose first sample lies at `first` in the camera frame; returns whether a sample was observed.
SACCADE_MULTIVERSION
bool fuseBrick(const Projection& p, const float* first, const float* x_offsets, const float* y_offsets,
               const float* z_offsets, std::int16_t* distances, std::uint16_t* weights) {
  const float x0 = first[0];
  const float y0 = first[1];
  const float z0 = first[2];
  const float cx = p.cx + 0.5F, cy = p.cy + 0.5F;
  const auto u_end = static_cast<float>(p.width), v_end = static_cast<float>(p.height);
  const float per_band = 1.0F / p.band;
  const FloatLanes zero = {};
  IntLanes observed = {};
  for (std::size_t i = 0; i < kSamples; i += kLanes) {
    const FloatLanes x = x0 + loadLanes(x_offsets + i);
    const FloatLanes y = y0 + loadLanes(y_offsets + i);
    const FloatLanes z = z0 + loadLanes(z_offsets + i);
    const FloatLanes per_z = 1.0F / z;
    const FloatLanes u = p.fx * x * per_z + cx;
    const FloatLanes v = p.fy * y * per_z + cy;
    const IntLanes inside = (z > 0.01F) & (u >= zero) & (v >= zero) & (u < u_end) & (v < v_end);
    if (!any(inside)) continue;
    const IntLanes pixel = truncated(inside ? v : zero) * p.width + truncated(inside ? u : zero);
    FloatLanes measured = {};
    for (std::size_t lane = 0; lane < kLanes; ++lane) measured[lane] = p.depth[pixel[lane]];
    // Along the ray: the difference of the depths times the length of the ray at depth 1.
    FloatLanes length = x * x + y * y + z * z;
    squareRoots(length);
    const FloatLanes raw = (measured - z) * length * per_z * per_band;
    const IntLanes seen = inside & (measured > zero) & (raw > -1.0F);
    if (!any(seen)) continue;
    observed |= seen;

    const FloatLanes target = least(raw, allLanes(1.0F)) * SurfaceBrick::kDistanceScale;
    const FloatLanes share = least(allLanes(1.0F), p.near_square / (measured * measured));
    Distances stored_distance;
    Weights stored_weight;
    std::memcpy(&stored_distance, distances + i, sizeof stored_distance);
    std::memcpy(&stored_weight, weights + i, sizeof stored_weight);
    const IntLanes old_distance = __builtin_convertvector(stored_distance, IntLanes);
    const IntLanes old_weight = __builtin_convertvector(stored_weight, IntLanes);
    const FloatLanes old = toFloat(old_distance), before = toFloat(old_weight);
    const FloatLanes added = share * SurfaceBrick::kWeightScale;
    const FloatLanes sum = before + added;
    const FloatLanes moved = old + (target - old) * (added / sum);
    const IntLanes rounded = truncated(moved + 32768.5F) - 32768;
    const IntLanes weight = truncated(least(sum, most(allLanes(p.weight_cap), before)) + 0.5F);
    const IntLanes kept = weight > 0 ? rounded : IntLanes{} + SurfaceBrick::kUnknownDistance;
    stored_distance = __builtin_convertvector(seen ? kept : old_distance, Distances);
    stored_weight = __builtin_convertvector(seen ? weight : old_weight, Weights);
    std::memcpy(distances + i, &stored_distance, sizeof stored_distance);
    std::memcpy(weights + i, &stored_weight, sizeof stored_weight);
  }
  return any(observed);
}

// Largest depth of each tile of the image, 0 where nothing is measured.
void computeFarthest(const cv::Mat1f& depth, std::vector<float>& farthest) {
  const int columns = (depth.cols + kIntegrationTile - 1) / kIntegrationTile;
  const int rows = (depth.rows + kIntegrationTile - 1) / kIntegrationTile;
  farthest.assign(static_cast<std::size_t>(columns * rows), 0.0F);
  for (int v = 0; v < depth.rows; ++v) {
    float* out = farthest.data() + static_cast<std::ptrdiff_t>(v / kIntegrationTile) * columns;
    const float* in = depth[v];
    for (int tile = 0; tile < columns; ++tile) {
      const int end = std::min(depth.cols, (tile + 1) * kIntegrationTile);
      float most = out[tile];
      for (int u = tile * kIntegrationTile; u < end; ++u) most = std::max(most, in[u]);
      out[tile] = most;
    }
  }
}

// Whether something measured in the projection of a ball lies farther than `nearest`.
bool reaches(const std::vector<float>& farthest, const PinholeCamera& camera, const Eigen::Vector3f& centre,
             float radius, float nearest) {
  const float z = centre.z() - radius;
  if (z <= 0.05F) return true;  // the camera is in it or nearly so
  const int columns = (camera.width + kIntegrationTile - 1) / kIntegrationTile;
  const int rows = (camera.height + kIntegrationTile - 1) / kIntegrationTile;
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  // The ball's silhouette reaches at most radius / (z - radius) beyond either side of its centre, off the axis a little
  // more on the far side of it; the tangent through the nearest depth bounds both.
  const float u = fx * centre.x() / centre.z() + static_cast<float>(camera.cx);
  const float v = fy * centre.y() / centre.z() + static_cast<float>(camera.cy);
  const float spread_u = fx * radius / z * (1.0F + std::abs(centre.x()) / centre.z()) + 1.0F;
  const float spread_v = fy * radius / z * (1.0F + std::abs(centre.y()) / centre.z()) + 1.0F;
  const auto clampTile = [](float pixel, int count) {
    return static_cast<int>(std::clamp(pixel / kIntegrationTile, 0.0F, static_cast<float>(count - 1)));
  };
  const int u0 = clampTile(u - spread_u, columns), u1 = clampTile(u + spread_u, columns);
  const int v0 = clampTile(v - spread_v, rows), v1 = clampTile(v + spread_v, rows);
  for (int row = v0; row <= v1; ++row) {
    for (int column = u0; column <= u1; ++column) {
      if (farthest[static_cast<std::size_t>(row * columns + column)] > nearest) return true;
    }
  }
  return false;
}

}  // namespace

std::uint64_t blocksBehind(const SurfaceBrick& brick, double band_samples) {
  // Both signs meet at a surface, where distances change by one sample a sample: two are enough for any diagonal.
  const auto deepest =
      static_cast<std::int16_t>(-SurfaceBrick::kDistanceScale * static_cast<float>(2.0 / band_samples));
  using Row = std::int16_t __attribute__((vector_size(16)));
  std::uint64_t blocks = 0;
  for (unsigned row = 0; row < 16; ++row) {  // of blocks: y from 0 to 3 in each of four z
    const std::int16_t* first = &brick.distance[(row & 3U) * 2 * kSide + (row >> 2U) * 2 * kSide * kSide];
    Row behind = {};
    for (const int line : {0, kSide, kSide * kSide, kSide * kSide + kSide}) {
      Row samples;
      std::memcpy(&samples, first + line, sizeof samples);
      behind |= (samples < 0) & (samples > deepest);
    }
    const auto pairs = reinterpret_cast<std::int32_t __attribute__((vector_size(16)))>(behind);
    for (unsigned x = 0; x < 4; ++x) blocks |= std::uint64_t{pairs[x] != 0} << (4 * row + x);
  }
  return blocks;
}

void SurfaceVolume::allocateBand(const DepthMaps& depth, const Pose& T_WC) {
  const PinholeCamera& camera = depth.camera;
  const double brick_m = kSide * config_.cell_m;
  // Neighbouring samples of the image are at most half a brick apart on a surface that faces the camera.
  const int stride = std::clamp(static_cast<int>(0.5 * brick_m * camera.fx / config_.max_range_m), 1, 4);
  const double band = config_.band_cells * config_.cell_m;
  const int steps = std::max(1, static_cast<int>(std::ceil(2.0 * band / (0.5 * brick_m))));
  const Eigen::Matrix3f R = (T_WC.linear() / brick_m).cast<float>();
  const Eigen::Vector3f t = (T_WC.translation() / brick_m).cast<float>();
  const auto max_range = static_cast<float>(config_.max_range_m);
  for (int v = 0; v < camera.height; v += stride) {
    BrickPosition last{INT32_MIN, 0, 0};
    for (int u = 0; u < camera.width; u += stride) {
      const float z = depth.depth_m(v, u);
      if (!(z > 0.0F) || z > max_range) continue;
      const Eigen::Vector3f ray = R * camera.unproject(u, v, 1.0).cast<float>();
      for (int k = 0; k <= steps; ++k) {
        const float at = z + static_cast<float>(band * (2.0 * k / steps - 1.0));
        const Eigen::Vector3f b = (t + at * ray).array().floor();
        const BrickPosition position{static_cast<int>(b.x()), static_cast<int>(b.y()), static_cast<int>(b.z())};
        if (position == last) continue;
        last = position;
        findOrAllocate(position);
      }
    }
  }
}

void SurfaceVolume::integrate(const DepthMaps& depth, const Pose& T_WC) {
  requireUsablePose(T_WC, "T_WC");
  ++changes_;
  allocateBand(depth, T_WC);
  findVisible(depth.camera, T_WC);
  computeFarthest(depth.depth_m, scratch_->farthest);

  const PinholeCamera& camera = depth.camera;
  const auto cell = static_cast<float>(config_.cell_m);
  const Eigen::Matrix3f R = T_WC.linear().transpose().cast<float>() * cell;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3f offset = R * Eigen::Vector3i(i & 7, (i >> 3) & 7, i >> 6).cast<float>();
    for (int axis = 0; axis < 3; ++axis) {
      scratch_->offsets[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)] = offset[axis];
    }
  }
  const float band = static_cast<float>(config_.band_cells) * cell;
  const auto near_weight = static_cast<float>(config_.near_weight_m);
  const Projection projection{depth.depth_m[0],
                              camera.width,
                              camera.height,
                              static_cast<float>(camera.fx),
                              static_cast<float>(camera.fy),
                              static_cast<float>(camera.cx),
                              static_cast<float>(camera.cy),
                              band,
                              near_weight * near_weight,
                              static_cast<float>(config_.weight_cap) * SurfaceBrick::kWeightScale};
  const float radius = std::sqrt(3.0F) / 2.0F * kSide * cell;
  const Eigen::Vector3f to_first = -R * Eigen::Vector3f::Constant((kSide - 1) / 2.0F);
  for (std::size_t i = 0; i < scratch_->visible.size(); ++i) {
    const Eigen::Vector3f& centre = scratch_->centres[i];
    // Wholly behind everything that is measured in its direction: hidden, nothing is learnt about it.
    if (!reaches(scratch_->farthest, camera, centre, radius, centre.z() - radius - band)) continue;
    const auto index = static_cast<std::size_t>(scratch_->visible[i]);
    const Eigen::Vector3f first = centre + to_first;
    const bool observed =
        fuseBrick(projection, first.data(), scratch_->offsets[0].data(), scratch_->offsets[1].data(),
                  scratch_->offsets[2].data(), bricks_[index]->distance.data(), bricks_[index]->weight.data());
    if (!observed) continue;
    behind_[index] = blocksBehind(*bricks_[index], config_.band_cells);
    last_change_[index] = changes_;
  }
}

}  // namespace saccade
