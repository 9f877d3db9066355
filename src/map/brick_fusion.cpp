#include "map/brick_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;
using Projection = BrickFusion::Projection;

// Half edges of the boxes around the samples of a brick, and of an eighth of it, in samples.
constexpr float kHalfBrick = (kSide - 1) / 2.0F, kHalfOctant = (kSide / 2 - 1) / 2.0F;

// Eight samples as a brick stores them.
using Distances = std::int16_t __attribute__((vector_size(16)));
using Weights = std::uint16_t __attribute__((vector_size(16)));

// Of eight boxes, those that may hold something not hidden, of which a part lies less than the band behind something
// measured in its direction; and those that lie in the frustum.
struct SeenBoxes {
  IntLanes reached, inside;
};

// (x, y, z) are the boxes' centres in the camera frame; their edges are along the world's axes.
SACCADE_INLINE void lookAtBoxes(const Projection& p, const DepthWindows::Table& windows, const FloatLanes& x,
                                const FloatLanes& y, const FloatLanes& z, float half_m, SeenBoxes& boxes) {
  constexpr float kNearest_m = 0.05F;  // nearer boxes have no useful bounds in the image
  constexpr float kRounding_px = 0.05F;
  const std::array<float, 9>& R = p.R_CW;
  const FloatLanes near = z - half_m * (std::abs(R[6]) + std::abs(R[7]) + std::abs(R[8]));
  const IntLanes close = near <= kNearest_m;
  // A corner c + d of the box has x / z = c.x / c.z + (d.x - (c.x / c.z) d.z) / (c.z + d.z).
  const FloatLanes per_z = 1.0F / (close ? allLanes(1.0F) : z);
  const FloatLanes per_near = half_m / (close ? allLanes(1.0F) : near);
  const FloatLanes tx = x * per_z, ty = y * per_z;
  const FloatLanes across = magnitude(R[0] - tx * R[6]) + magnitude(R[1] - tx * R[7]) + magnitude(R[2] - tx * R[8]);
  const FloatLanes down = magnitude(R[3] - ty * R[6]) + magnitude(R[4] - ty * R[7]) + magnitude(R[5] - ty * R[8]);
  const FloatLanes u = p.fx * tx + (p.cx + 0.5F), v = p.fy * ty + (p.cy + 0.5F);
  const FloatLanes reach_u = p.fx * across * per_near + kRounding_px, reach_v = p.fy * down * per_near + kRounding_px;
  boxes.reached = close | (farthestAround(windows, u, v, reach_u, reach_v) > near - p.band);
  boxes.inside = ~close & (u - reach_u > 0.0F) & (v - reach_v > 0.0F) & (u + reach_u < static_cast<float>(p.width)) &
                 (v + reach_v < static_cast<float>(p.height));
}

// Writes the indices of those of the bricks around `centres` (x, y, z of each) that are not wholly hidden; returns how
// many. `reached` has room for kLanes more than `count`.
SACCADE_MULTIVERSION
std::size_t findReached(const Projection& p, const DepthWindows::Table& windows, const float* centres,
                        std::size_t count, std::int32_t* reached) {
  std::size_t found = 0;
  for (std::size_t first = 0; first < count; first += kLanes) {
    FloatLanes x = {}, y = {}, z = {};
    const std::size_t lanes = std::min<std::size_t>(kLanes, count - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      x[lane] = centres[3 * (first + lane)];
      y[lane] = centres[3 * (first + lane) + 1];
      z[lane] = centres[3 * (first + lane) + 2];
    }
    SeenBoxes boxes;
    lookAtBoxes(p, windows, x, y, z, kHalfBrick * p.cell, boxes);
    const unsigned seen = bitsOf(boxes.reached);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      reached[found] = static_cast<std::int32_t>(first + lane);
      found += seen >> lane & 1U;
    }
  }
  return found;
}

constexpr unsigned kWhollyInside = 16;

// Quarters of a brick, 8 x 4 x 4 samples (x, y, z), bit y + 2 z: those that are not wholly hidden; and kWhollyInside if
// all lie in the frustum.
SACCADE_INLINE unsigned reachedQuarters(const Projection& p, const DepthWindows::Table& windows, const float* centre) {
  SeenBoxes boxes;
  lookAtBoxes(p, windows, loadLanes(p.octants[0].data()) + centre[0], loadLanes(p.octants[1].data()) + centre[1],
              loadLanes(p.octants[2].data()) + centre[2], kHalfOctant * p.cell, boxes);
  const unsigned seen = bitsOf(boxes.reached);
  const unsigned pairs = seen | seen >> 1U;
  return (pairs & 1U) | (pairs >> 1U & 2U) | (pairs >> 2U & 4U) | (pairs >> 3U & 8U) |
         (any(~boxes.inside) ? 0U : kWhollyInside);
}

// Eight samples that learn something: how far the measured surface is beyond each, as a share of the band, the depth
// measured there, and which of them do.
struct SeenRow {
  alignas(32) float beyond[kLanes];
  alignas(32) float measured[kLanes];
  alignas(32) std::int32_t seen[kLanes];
  std::size_t first;  // of the samples
};

// Compares quarters of a brick with the image and writes those of its rows that learn something to `rows`; returns how
// many. `kInside`: the brick lies in the frustum.
template <bool kInside>
SACCADE_INLINE std::size_t compare(const Projection& p, const float* centre, unsigned quarters, SeenRow* rows) {
  std::size_t count = 0;
  const float x0 = centre[0] + p.first[0], y0 = centre[1] + p.first[1], z0 = centre[2] + p.first[2];
  const float cx = p.cx + 0.5F, cy = p.cy + 0.5F;
  const auto u_end = static_cast<float>(p.width), v_end = static_cast<float>(p.height);
  const float per_band = 1.0F / p.band;
  const FloatLanes zero = {};
  for (unsigned quarter = 0; quarter < 4; ++quarter) {
    if ((quarters >> quarter & 1U) == 0) continue;
    const std::size_t corner = kSide * (4 * (quarter & 1U) + kSide * (4 * (quarter >> 1U)));
    for (std::size_t row = 0; row < 16; ++row) {
      const std::size_t i = corner + kSide * ((row & 3U) + kSide * (row >> 2U));
      const FloatLanes x = x0 + loadLanes(&p.samples[0][i]);
      const FloatLanes y = y0 + loadLanes(&p.samples[1][i]);
      const FloatLanes z = z0 + loadLanes(&p.samples[2][i]);
      const FloatLanes per_z = 1.0F / z;
      FloatLanes u = p.fx * x * per_z + cx;
      FloatLanes v = p.fy * y * per_z + cy;
      IntLanes inside;
      if constexpr (!kInside) {
        inside = (z > 0.01F) & (u >= zero) & (v >= zero) & (u < u_end) & (v < v_end);
        u = inside ? u : zero;
        v = inside ? v : zero;
      }
      alignas(32) std::uint32_t pixel[kLanes];
      const IntLanes pixels = truncated(v) * p.width + truncated(u);
      std::memcpy(pixel, &pixels, sizeof pixel);
      FloatLanes measured = {};
      for (std::size_t lane = 0; lane < kLanes; ++lane) measured[lane] = p.depth[pixel[lane]];
      // Along the ray: the difference of the depths times the length of the ray at depth 1.
      FloatLanes length = x * x + y * y + z * z;
      squareRoots(length);
      const FloatLanes beyond = (measured - z) * length * per_z * per_band;
      IntLanes seen = (measured > zero) & (beyond > -1.0F);
      if constexpr (!kInside) seen &= inside;
      storeLanes(beyond, rows[count].beyond);
      storeLanes(measured, rows[count].measured);
      storeLanes(seen, rows[count].seen);
      rows[count].first = i;
      count += any(seen) ? 1 : 0;
    }
  }
  return count;
}

SACCADE_MULTIVERSION
bool fuseBrick(const Projection& p, const DepthWindows::Table& windows, const float* centre, std::int16_t* distances,
               std::uint16_t* weights) {
  const unsigned quarters = reachedQuarters(p, windows, centre);
  SeenRow rows[kSide * kSide];
  const std::size_t count = (quarters & kWhollyInside) != 0 ? compare<true>(p, centre, quarters, rows)
                                                            : compare<false>(p, centre, quarters, rows);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = rows[k].first;
    const FloatLanes measured = loadLanes(rows[k].measured);
    const IntLanes seen = loadLanes(rows[k].seen);
    const FloatLanes target = least(loadLanes(rows[k].beyond), allLanes(1.0F)) * SurfaceBrick::kDistanceScale;
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
  return count > 0;
}

}  // namespace

void BrickFusion::begin(const DepthMaps& depth, const Pose& T_WC, const SurfaceVolumeConfig& config) {
  windows_.build(depth.depth_m);
  Projection& p = projection_;
  const PinholeCamera& camera = depth.camera;
  p.depth = depth.depth_m[0];
  p.width = camera.width;
  p.height = camera.height;
  p.fx = static_cast<float>(camera.fx);
  p.fy = static_cast<float>(camera.fy);
  p.cx = static_cast<float>(camera.cx);
  p.cy = static_cast<float>(camera.cy);
  p.cell = static_cast<float>(config.cell_m);
  p.band = static_cast<float>(config.band_cells) * p.cell;
  const auto near_weight = static_cast<float>(config.near_weight_m);
  p.near_square = near_weight * near_weight;
  p.weight_cap = static_cast<float>(config.weight_cap) * SurfaceBrick::kWeightScale;

  const Eigen::Matrix3f R_CW = T_WC.linear().transpose().cast<float>();
  const Eigen::Matrix3f R = R_CW * p.cell;
  const Eigen::Vector3f first = -R * Eigen::Vector3f::Constant(kHalfBrick);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto row = static_cast<Eigen::Index>(axis);
    p.first[axis] = first[row];
    for (std::size_t k = 0; k < 3; ++k) p.R_CW[3 * axis + k] = R_CW(row, static_cast<Eigen::Index>(k));
    for (int i = 0; i < SurfaceBrick::kSamples; ++i) {
      const Eigen::Vector3f at = Eigen::Vector3i(i & 7, (i >> 3) & 7, i >> 6).cast<float>();
      p.samples[axis][static_cast<std::size_t>(i)] = R.row(row).dot(at);
    }
    for (int octant = 0; octant < kLanes; ++octant) {
      const Eigen::Vector3f side = Eigen::Vector3i(octant & 1, octant >> 1 & 1, octant >> 2).cast<float>();
      p.octants[axis][static_cast<std::size_t>(octant)] =
          R.row(row).dot(kSide / 2 * (side - Eigen::Vector3f::Constant(0.5F)));
    }
  }
}

void BrickFusion::findReached(const std::vector<Eigen::Vector3f>& centres, std::vector<std::int32_t>& reached) const {
  reached.clear();
  if (centres.empty()) return;
  reached.resize(centres.size() + kLanes);
  reached.resize(
      saccade::findReached(projection_, windows_.table(), centres[0].data(), centres.size(), reached.data()));
}

bool BrickFusion::fuse(const Eigen::Vector3f& centre, SurfaceBrick& brick) const {
  return fuseBrick(projection_, windows_.table(), centre.data(), brick.distance.data(), brick.weight.data());
}

}  // namespace saccade
