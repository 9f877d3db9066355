#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/lanes.hpp"
#include "map/depth_windows.hpp"
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
  std::array<float, 9> R_CW;
};

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
                        std::size_t count, float half_m, std::int32_t* reached) {
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
    lookAtBoxes(p, windows, x, y, z, half_m, boxes);
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
// all lie in the frustum. `octants` are the offsets from the brick's centre to those of its eighths, `half_m` half the
// edge of these.
SACCADE_MULTIVERSION
unsigned reachedQuarters(const Projection& p, const DepthWindows::Table& windows, const float* centre,
                         const float* octants, float half_m) {
  SeenBoxes boxes;
  lookAtBoxes(p, windows, loadLanes(octants) + centre[0], loadLanes(octants + kLanes) + centre[1],
              loadLanes(octants + 2 * kLanes) + centre[2], half_m, boxes);
  const unsigned seen = bitsOf(boxes.reached);
  if (seen == 0) return 0;
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

struct BrickView {
  const float* first;       // position of the first sample in the camera frame
  const float* offsets[3];  // of all samples from it, by axis
  unsigned quarters;        // those that are looked at
};

// Compares a brick with the image and writes those of its rows that learn something to `rows`; returns how many.
// `kInside`: the brick lies in the frustum.
template <bool kInside>
SACCADE_INLINE std::size_t compare(const Projection& p, const BrickView& brick, SeenRow* rows) {
  std::size_t count = 0;
  const float x0 = brick.first[0], y0 = brick.first[1], z0 = brick.first[2];
  const float cx = p.cx + 0.5F, cy = p.cy + 0.5F;
  const auto u_end = static_cast<float>(p.width), v_end = static_cast<float>(p.height);
  const float per_band = 1.0F / p.band;
  const FloatLanes zero = {};
  for (unsigned quarter = 0; quarter < 4; ++quarter) {
    if ((brick.quarters >> quarter & 1U) == 0) continue;
    const std::size_t corner = kSide * (4 * (quarter & 1U) + kSide * (4 * (quarter >> 1U)));
    for (std::size_t row = 0; row < 16; ++row) {
      const std::size_t i = corner + kSide * ((row & 3U) + kSide * (row >> 2U));
      const FloatLanes x = x0 + loadLanes(brick.offsets[0] + i);
      const FloatLanes y = y0 + loadLanes(brick.offsets[1] + i);
      const FloatLanes z = z0 + loadLanes(brick.offsets[2] + i);
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

// Updates a brick; returns whether a sample was observed.
SACCADE_MULTIVERSION
bool fuseBrick(const Projection& p, const BrickView& brick, std::int16_t* distances, std::uint16_t* weights) {
  SeenRow rows[kSide * kSide];
  const std::size_t count =
      (brick.quarters & kWhollyInside) != 0 ? compare<true>(p, brick, rows) : compare<false>(p, brick, rows);
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

// A row of an image: pixel u at depth z lies at origin + z * (start + u * column), in bricks from `home` on.
struct BandRays {
  float origin[3], start[3], column[3];
  std::int32_t home[3];
  int stride;           // pixels
  int steps;            // from one end of the band to the other
  float before, apart;  // where the first step lies from the measured depth, and how far they are apart, metres
  float max_range;      // metres
};

constexpr unsigned kKnownBits = 4;  // of a position along each axis
constexpr BrickPosition kNowhere{INT32_MIN, INT32_MIN, INT32_MIN};

std::size_t slotOf(const BrickPosition& p) {
  constexpr unsigned kMask = (1U << kKnownBits) - 1U;
  return (static_cast<unsigned>(p.x) & kMask) | (static_cast<unsigned>(p.y) & kMask) << kKnownBits |
         (static_cast<unsigned>(p.z) & kMask) << 2 * kKnownBits;
}

// Writes the bricks in which every stride-th pixel's ray meets the band, one for each step; returns how many.
SACCADE_MULTIVERSION
std::size_t findBand(const BandRays& rays, const float* depth, int width, BrickPosition* met) {
  std::size_t count = 0;
  const IntLanes lane = {0, 1, 2, 3, 4, 5, 6, 7};
  for (int u = 0; u < width; u += rays.stride * kLanes) {
    FloatLanes z = {};
    for (int i = 0; i < kLanes; ++i) {
      const int at = u + i * rays.stride;
      z[i] = at < width ? depth[at] : 0.0F;
    }
    const unsigned measured = bitsOf((z > 0.0F) & (z <= rays.max_range));
    if (measured == 0) continue;
    const FloatLanes column = toFloat(lane * rays.stride + u);
    FloatLanes direction[3];
    for (std::size_t axis = 0; axis < 3; ++axis) direction[axis] = rays.start[axis] + column * rays.column[axis];
    for (int k = 0; k <= rays.steps; ++k) {
      const FloatLanes at = z + (rays.before + static_cast<float>(k) * rays.apart);
      alignas(32) std::int32_t position[3][kLanes];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const FloatLanes p = rays.origin[axis] + at * direction[axis];
        const IntLanes whole = truncated(p);
        storeLanes(whole + (toFloat(whole) > p) + rays.home[axis], position[axis]);  // true is -1: rounds down
      }
      for (std::size_t i = 0; i < kLanes; ++i) {
        met[count] = {position[0][i], position[1][i], position[2][i]};
        count += measured >> i & 1U;
      }
    }
  }
  return count;
}

}  // namespace

SACCADE_MULTIVERSION
std::uint64_t blocksBehind(const SurfaceBrick& brick, double band_samples) {
  // Both signs meet at a surface, where distances change by one sample a sample: two are enough for any diagonal.
  const auto deepest =
      static_cast<std::int16_t>(-SurfaceBrick::kDistanceScale * static_cast<float>(2.0 / band_samples));
  using Lines = std::int16_t __attribute__((vector_size(32)));  // two lines of samples, one after the other in y
  std::uint64_t blocks = 0;
  for (unsigned row = 0; row < 16; ++row) {  // of blocks: y from 0 to 3 in each of four z
    const std::int16_t* first = &brick.distance[(row & 3U) * 2 * kSide + (row >> 2U) * 2 * kSide * kSide];
    Lines here, above;
    std::memcpy(&here, first, sizeof here);
    std::memcpy(&above, first + kSide * kSide, sizeof above);
    const Lines behind = ((here < 0) & (here > deepest)) | ((above < 0) & (above > deepest));
    const unsigned pairs = bitsOf(reinterpret_cast<IntLanes>(behind) != 0);
    blocks |= std::uint64_t{(pairs | pairs >> 4U) & 15U} << 4 * row;
  }
  return blocks;
}

void SurfaceVolume::allocateBand(const DepthMaps& depth, const Pose& T_WC) {
  const PinholeCamera& camera = depth.camera;
  const double brick_m = kSide * config_.cell_m;
  const double band = config_.band_cells * config_.cell_m;
  BandRays rays{};
  // Neighbouring samples of the image are at most half a brick apart on a surface that faces the camera, and so are
  // those of a ray.
  rays.stride = std::clamp(static_cast<int>(0.5 * brick_m * camera.fx / config_.max_range_m), 1, 4);
  rays.steps = std::max(1, static_cast<int>(std::ceil(2.0 * band / (0.5 * brick_m))));
  rays.before = static_cast<float>(-band);
  rays.apart = static_cast<float>(2.0 * band / rays.steps);
  rays.max_range = static_cast<float>(config_.max_range_m);
  const Eigen::Vector3d t = T_WC.translation() / brick_m;
  const Eigen::Vector3d home = t.array().floor();
  const Eigen::Matrix3d R = T_WC.linear() / brick_m;
  for (int axis = 0; axis < 3; ++axis) {
    rays.origin[axis] = static_cast<float>(t[axis] - home[axis]);
    rays.home[axis] = static_cast<int>(home[axis]);
    rays.column[axis] = static_cast<float>(R(axis, 0) / camera.fx);
  }

  std::vector<BrickPosition>& met = scratch_->met;
  std::vector<BrickPosition>& known = scratch_->known;
  const auto samples = static_cast<std::size_t>((camera.width + rays.stride - 1) / rays.stride + kLanes);
  met.resize(samples * static_cast<std::size_t>(rays.steps + 1));
  known.assign(std::size_t{1} << (3 * kKnownBits), kNowhere);
  for (int v = 0; v < camera.height; v += rays.stride) {
    const Eigen::Vector3d start = R * camera.unproject(0.0, v, 1.0);
    for (int axis = 0; axis < 3; ++axis) rays.start[axis] = static_cast<float>(start[axis]);
    const std::size_t count = findBand(rays, depth.depth_m[v], camera.width, met.data());
    for (std::size_t i = 0; i < count; ++i) {
      // Few rays meet a brick first: it is looked up once, until another one takes its place here.
      BrickPosition& same = known[slotOf(met[i])];
      if (same == met[i]) continue;
      same = met[i];
      findOrAllocate(met[i]);
    }
  }
}

void SurfaceVolume::integrate(const DepthMaps& depth, const Pose& T_WC) {
  requireUsablePose(T_WC, "T_WC");
  ++changes_;
  allocateBand(depth, T_WC);
  findVisible(depth.camera, T_WC);
  if (scratch_->visible.empty()) return;
  scratch_->windows.build(depth.depth_m);

  const PinholeCamera& camera = depth.camera;
  const auto cell = static_cast<float>(config_.cell_m);
  const Eigen::Matrix3f R_CW = T_WC.linear().transpose().cast<float>();
  const Eigen::Matrix3f R = R_CW * cell;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3f offset = R * Eigen::Vector3i(i & 7, (i >> 3) & 7, i >> 6).cast<float>();
    for (int axis = 0; axis < 3; ++axis) {
      scratch_->offsets[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)] = offset[axis];
    }
  }
  const float band = static_cast<float>(config_.band_cells) * cell;
  const auto near_weight = static_cast<float>(config_.near_weight_m);
  Projection projection{depth.depth_m[0],
                        camera.width,
                        camera.height,
                        static_cast<float>(camera.fx),
                        static_cast<float>(camera.fy),
                        static_cast<float>(camera.cx),
                        static_cast<float>(camera.cy),
                        band,
                        near_weight * near_weight,
                        static_cast<float>(config_.weight_cap) * SurfaceBrick::kWeightScale,
                        {}};
  for (int i = 0; i < 9; ++i) projection.R_CW[static_cast<std::size_t>(i)] = R_CW(i / 3, i % 3);
  alignas(32) std::array<float, 3 * kLanes> octants;
  for (int octant = 0; octant < kLanes; ++octant) {
    const Eigen::Vector3i side(octant & 1, octant >> 1 & 1, octant >> 2);
    const Eigen::Vector3f offset = R * (4.0F * side.cast<float>() - Eigen::Vector3f::Constant(2.0F));
    for (int axis = 0; axis < 3; ++axis) octants[static_cast<std::size_t>(axis * kLanes + octant)] = offset[axis];
  }
  const Eigen::Vector3f to_first = -R * Eigen::Vector3f::Constant((kSide - 1) / 2.0F);
  const DepthWindows::Table& windows = scratch_->windows.table();
  std::vector<std::int32_t>& reached = scratch_->reached;
  const std::size_t visible = scratch_->visible.size();
  reached.resize(visible + kLanes);
  reached.resize(findReached(projection, windows, scratch_->centres[0].data(), visible, (kSide - 1) / 2.0F * cell,
                             reached.data()));
  for (const std::int32_t i : reached) {
    const Eigen::Vector3f& centre = scratch_->centres[static_cast<std::size_t>(i)];
    const unsigned quarters = reachedQuarters(projection, windows, centre.data(), octants.data(), 1.5F * cell);
    if (quarters == 0) continue;
    const auto index = static_cast<std::size_t>(scratch_->visible[static_cast<std::size_t>(i)]);
    const Eigen::Vector3f first = centre + to_first;
    const BrickView brick{first.data(),
                          {scratch_->offsets[0].data(), scratch_->offsets[1].data(), scratch_->offsets[2].data()},
                          quarters};
    const bool observed = fuseBrick(projection, brick, bricks_[index]->distance.data(), bricks_[index]->weight.data());
    if (!observed) continue;
    behind_[index] = blocksBehind(*bricks_[index], config_.band_cells);
    last_change_[index] = changes_;
  }
}

}  // namespace saccade
