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

  BrickFusion& fusion = scratch_->fusion;
  fusion.begin(depth, T_WC, config_);
  fusion.findReached(scratch_->centres, scratch_->reached);
  for (const std::int32_t reached : scratch_->reached) {
    const auto i = static_cast<std::size_t>(reached);
    const auto index = static_cast<std::size_t>(scratch_->visible[i]);
    if (!fusion.fuse(scratch_->centres[i], *bricks_[index])) continue;
    behind_[index] = blocksBehind(*bricks_[index], config_.band_cells);
    last_change_[index] = changes_;
  }
}

}  // namespace saccade
