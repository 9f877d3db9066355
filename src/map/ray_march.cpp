#include "map/ray_march.hpp"

#include <algorithm>
#include <bit>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;
constexpr int kEdge = SurfaceGrid::kEdge;

/// Distances of the eight samples around one point per lane: neighbours along x in one word, the lower one in the
/// lower half; words in the order (y, z) = 00, 10, 01, 11.
struct Corners {
  alignas(32) std::uint32_t pairs[4][kLanes];
  alignas(32) std::int32_t copies[kLanes];  // 0: no surface runs through the brick around the point
};

/// Copies `lines` lines of samples in y and the first samples of the next brick in x.
std::int16_t* copyLines(const SurfaceBrick* const* brick, int z, int lines, std::int16_t* to) {
  const std::int16_t* from = brick[0]->distance.data() + z * kSide * kSide;
  const std::int16_t* next = brick[1]->distance.data() + z * kSide * kSide;
  for (int y = 0; y < lines; ++y, from += kSide, next += kSide, to += kEdge) {
    std::memcpy(to, from, kSide * sizeof *to);
    to[kSide] = *next;
  }
  return to;
}

/// Copies the samples of a brick and the first ones of its upper neighbours to `to`.
void copyBrick(const SurfaceGrid& grid, std::int32_t slot, std::int16_t* to) {
  const SurfaceBrick* const* brick = grid.bricks + slot;
  for (int z = 0; z <= kSide; ++z) {
    const SurfaceBrick* const* at = z == kSide ? brick + grid.slice : brick;
    to = copyLines(at, z % kSide, kSide, to);
    to = copyLines(at + grid.row, z % kSide, 1, to);
  }
}

/// Copies those of eight bricks that are not copied yet.
void copyBricks(SurfaceGrid& grid, const std::int32_t* slots) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    std::int32_t& copy = grid.copies[slots[lane]];
    if (copy != SurfaceGrid::kNotCopied) continue;
    copy = grid.end;
    copyBrick(grid, slots[lane], grid.samples + copy);
    grid.end += SurfaceGrid::kCopy;
  }
}

/// Reads the samples around the points whose lowest neighbour is `whole`; of lanes that are not open unknown ones.
SACCADE_INLINE void readCorners(SurfaceGrid& grid, const IntLanes (&whole)[3], const IntLanes& open, Corners& corners) {
  const IntLanes slot = open & ((whole[0] >> 3) + (whole[1] >> 3) * grid.row + (whole[2] >> 3) * grid.slice);
  const IntLanes place = (whole[0] & 7) + (whole[1] & 7) * kEdge + (whole[2] & 7) * (kEdge * kEdge);
  alignas(32) std::int32_t slots[kLanes], places[kLanes];
  storeLanes(slot, slots);
  std::int32_t signs = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    corners.copies[lane] = grid.copies[slots[lane]];
    signs |= corners.copies[lane];
  }
  if (signs < 0) {
    copyBricks(grid, slots);
    for (std::size_t lane = 0; lane < kLanes; ++lane) corners.copies[lane] = grid.copies[slots[lane]];
  }
  storeLanes(place, places);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::int16_t* at = grid.samples + (corners.copies[lane] + places[lane]);
    std::memcpy(&corners.pairs[0][lane], at, 4);
    std::memcpy(&corners.pairs[1][lane], at + kEdge, 4);
    std::memcpy(&corners.pairs[2][lane], at + kEdge * kEdge, 4);
    std::memcpy(&corners.pairs[3][lane], at + kEdge * kEdge + kEdge, 4);
  }
}

/// Trilinear distance and its gradient per sample, as shares of the band; `known` where all eight samples are.
struct Sampled {
  FloatLanes distance;
  FloatLanes gradient[3];
  IntLanes known;
};

SACCADE_INLINE void interpolate(const Corners& corners, const FloatLanes& fx, const FloatLanes& fy,
                                const FloatLanes& fz, Sampled& out) {
  FloatLanes low[4], along_x[4];
  FloatLanes lowest = {};
  for (std::size_t k = 0; k < 4; ++k) {
    IntLanes pair;
    std::memcpy(&pair, corners.pairs[k], sizeof pair);
    const FloatLanes a = toFloat((pair << 16) >> 16), b = toFloat(pair >> 16);
    lowest = least(lowest, least(a, b));
    along_x[k] = b - a;
    low[k] = a + fx * along_x[k];
  }
  constexpr float kPerUnit = 1.0F / SurfaceBrick::kDistanceScale;
  const FloatLanes near_y = low[1] - low[0], far_y = low[3] - low[2];
  const FloatLanes near = low[0] + fy * near_y, far = low[2] + fy * far_y;
  const FloatLanes near_x = along_x[0] + fy * (along_x[1] - along_x[0]);
  const FloatLanes far_x = along_x[2] + fy * (along_x[3] - along_x[2]);
  out.distance = (near + fz * (far - near)) * kPerUnit;
  out.gradient[0] = (near_x + fz * (far_x - near_x)) * kPerUnit;
  out.gradient[1] = (near_y + fz * (far_y - near_y)) * kPerUnit;
  out.gradient[2] = (far - near) * kPerUnit;
  out.known = lowest > static_cast<float>(SurfaceBrick::kUnknownDistance);
}

using UnsignedLanes = std::uint32_t __attribute__((vector_size(32)));

/// Number of the lowest bit that is set, from the exponent of its value; anything where none is.
SACCADE_INLINE IntLanes lowestBit(const IntLanes& bits) {
  const FloatLanes lowest = toFloat(bits & -bits);
  return ((reinterpret_cast<IntLanes>(lowest) >> 23) & 0xFF) - 127;
}

constexpr float kNone = -1.0F;  // of a depth
constexpr float kHit = -2.0F;   // `behind` a surface that was met: at depth `before`, with its gradient as `direction`

}  // namespace

void RayQueue::reset(std::size_t most) {
  count_ = 0;
  if (most + kLanes <= room_) return;
  room_ = most + kLanes;
  pixel_.resize(room_);
  slices_.resize(room_);
  depth_.resize(room_);
  fields_.resize(kFields * room_);
}

void RayQueue::march(SurfaceGrid& grid, const RayFan& fan, float far, const View& view) {
  constexpr int kSteps = 3;  // after so many most rays are done, and the others close up
  const auto field = [this](std::size_t i) { return fields_.data() + i * room_; };
  const Rays rays{pixel_.data(), slices_.data(), depth_.data(), field(0), {field(1), field(2), field(3)},
                  field(4),      field(5),       field(6),      field(7)};
  begin(grid, fan, far, rays, count_);
  while (count_ > 0) {
    for (int i = 0; i < kSteps; ++i) step(grid, fan, rays, count_);
    count_ = closeUp(fan, rays, count_, view);
  }
}

SACCADE_MULTIVERSION
void RayQueue::begin(const SurfaceGrid& grid, const RayFan& fan, float far, const Rays& rays, std::size_t count) {
  constexpr float kSmallest = 1e-6F;  // of a direction's component: keeps its inverse finite
  constexpr float kLead_samples = 2.0F;
  for (std::size_t first = 0; first < count; first += kLanes) {
    const IntLanes pixel = loadLanes(rays.pixel + first);
    const FloatLanes u = toFloat(pixel & 0xFFFF), v = toFloat(pixel >> 16);
    FloatLanes z = loadLanes(rays.depth + first), end = allLanes(far), square = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const FloatLanes d = fan.start[axis] + u * fan.column[axis] + v * fan.row[axis];
      const FloatLanes direction = magnitude(d) < kSmallest ? allLanes(kSmallest) : d;
      const FloatLanes inverse = 1.0F / direction;
      const FloatLanes a = (1.0F - fan.origin[axis]) * inverse;
      const FloatLanes b = (grid.high[axis] - fan.origin[axis]) * inverse;
      z = most(z, least(a, b));
      end = least(end, most(a, b));
      square += direction * direction;
      storeLanes(direction, rays.direction[axis] + first);
    }
    squareRoots(square);
    const FloatLanes sample = 1.0F / square;
    storeLanes(sample, rays.sample + first);
    storeLanes(z + kLead_samples * sample, rays.depth + first);
    storeLanes(end, rays.end + first);
    storeLanes(z, rays.before + first);
    storeLanes(allLanes(kLead_samples / fan.band_samples), rays.f_before + first);
    storeLanes(allLanes(kNone), rays.behind + first);
  }
}

/// Takes one step on each ray; what is done has its depth at its end.
SACCADE_MULTIVERSION
void RayQueue::step(SurfaceGrid& grid, const RayFan& fan, const Rays& rays, std::size_t count) {
  constexpr float kClose_samples = 3.5F, kBeyond_samples = 0.5F, kShortfall = 0.8F;
  constexpr float kConverged_samples = 0.1F;
  constexpr float kBlind_samples = 2.5F;  // on unknown ground: shorter than the known band before a surface
  const float per_slice = 1.0F / fan.slice_m;
  const IntLanes lane = {0, 1, 2, 3, 4, 5, 6, 7}, no = {};
  const FloatLanes zero = {}, none = zero + kNone;
  Corners corners{};
  for (std::size_t first = 0; first < count; first += kLanes) {
    const FloatLanes z = loadLanes(rays.depth + first), end = loadLanes(rays.end + first);
    IntLanes open = z < end;
    if (count - first < kLanes) open &= lane < static_cast<std::int32_t>(count - first);
    if (!any(open)) continue;
    const FloatLanes sample = loadLanes(rays.sample + first);
    const FloatLanes before = loadLanes(rays.before + first), f_before = loadLanes(rays.f_before + first);
    const FloatLanes behind = loadLanes(rays.behind + first);
    // Positions are above 0 and so truncation is floor; lanes that are done stay inside the grid.
    const FloatLanes at = open ? z : zero;
    FloatLanes direction[3], fraction[3];
    IntLanes whole[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      direction[axis] = loadLanes(rays.direction[axis] + first);
      const FloatLanes p = fan.origin[axis] + at * direction[axis];
      whole[axis] = truncated(p);
      fraction[axis] = p - toFloat(whole[axis]);
    }
    readCorners(grid, whole, open, corners);
    Sampled here;
    interpolate(corners, fraction[0], fraction[1], fraction[2], here);
    const IntLanes nothing_near = loadLanes(corners.copies) == SurfaceGrid::kNoSurface;
    const IntLanes positive = here.known & (here.distance > zero);
    const IntLanes refining = behind >= zero;
    const FloatLanes slope =
        here.gradient[0] * direction[0] + here.gradient[1] * direction[1] + here.gradient[2] * direction[2];
    const IntLanes facing = here.known & (slope < zero);
    const FloatLanes ahead = here.distance / (facing ? -slope : allLanes(1.0F));

    // Close enough, or between a sample on either side: one Newton step along the ray, and it is there.
    const IntLanes near = (positive | (before >= zero)) & (magnitude(ahead) < kConverged_samples * sample);
    const IntLanes hit = open & facing & (near | refining);
    const FloatLanes newton = z + ahead;
    const FloatLanes met = refining ? most(before, least(behind, newton)) : newton;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      storeLanes(hit ? here.gradient[axis] : direction[axis], rays.direction[axis] + first);
    }

    // Far from the surface short of it; close to it as far as the slope says, or a little beyond it where there is
    // none. From the surface's back, or on unknown ground, the search goes on.
    const FloatLanes samples_away = here.distance * fan.band_samples;
    const FloatLanes beyond = (samples_away + kBeyond_samples) * sample;
    const FloatLanes closer = facing ? least(most(ahead, samples_away * sample), beyond) : beyond;
    const FloatLanes stride = samples_away < kClose_samples ? closer : samples_away * kShortfall * sample;
    FloatLanes next = z + (positive ? stride : (here.known ? allLanes(1.0F) : allLanes(kBlind_samples)) * sample);
    if (any(open & nothing_near)) {  // on to where the ray leaves the brick
      FloatLanes exit = allLanes(1e9F);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const IntLanes edge = (whole[axis] & ~7) + (direction[axis] > zero ? no + kSide : no);
        exit = least(exit, (toFloat(edge) - fan.origin[axis]) / direction[axis]);
      }
      next = nothing_near ? most(z + 0.02F * sample, exit + 0.01F * sample) : next;
    }
    next = refining ? behind + sample : next;
    // On to the next slice that can hold a surface, if this one does not.
    const IntLanes slice = truncated(least(next * per_slice, allLanes(31.0F)));
    const IntLanes to_come = reinterpret_cast<IntLanes>(
        reinterpret_cast<UnsignedLanes>(loadLanes(rays.slices + first)) >> reinterpret_cast<UnsignedLanes>(slice));
    const IntLanes empty = (to_come & 1) == 0;
    const FloatLanes there = toFloat(slice + lowestBit(to_come)) * fan.slice_m;
    next = empty ? (to_come == 0 ? end : there) : next;

    const IntLanes crossed = here.known & ~positive & (before >= zero) & ~refining;
    const FloatLanes secant = before + (z - before) * f_before / (f_before - here.distance);
    const FloatLanes last = hit ? met : crossed ? before : positive & ~refining & ~empty ? z : none;
    storeLanes(open ? last : before, rays.before + first);
    storeLanes(positive ? here.distance : f_before, rays.f_before + first);
    storeLanes(open ? hit ? zero + kHit : crossed ? z : none : behind, rays.behind + first);
    storeLanes(open ? hit ? end : crossed ? secant : next : z, rays.depth + first);
  }
}

/// Shows what was met, and has the rays that are not done follow each other; returns how many.
SACCADE_MULTIVERSION
std::size_t RayQueue::closeUp(const RayFan& fan, const Rays& rays, std::size_t count, const View& view) {
  std::size_t left = 0;
  for (std::size_t first = 0; first < count; first += kLanes) {
    const unsigned there = count - first < kLanes ? (1U << (count - first)) - 1U : 0xFFU;
    unsigned hits = there & bitsOf(loadLanes(rays.behind + first) == kHit);
    unsigned going = there & bitsOf(loadLanes(rays.depth + first) < loadLanes(rays.end + first));
    FloatLanes gradient[3], square = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      gradient[axis] = loadLanes(rays.direction[axis] + first);
      square += gradient[axis] * gradient[axis];
    }
    squareRoots(square);
    const FloatLanes scale = 1.0F / square;
    alignas(32) float normals[3][kLanes];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float* r = fan.rotation + 3 * axis;
      storeLanes((r[0] * gradient[0] + r[1] * gradient[1] + r[2] * gradient[2]) * scale, normals[axis]);
    }
    for (; hits != 0; hits &= hits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(hits));
      const auto column = static_cast<std::size_t>(rays.pixel[first + i] & 0xFFFF);
      const auto row = static_cast<std::size_t>(rays.pixel[first + i] >> 16);
      view.depth_m[row * view.depth_stride + column] = rays.before[first + i];
      float* normal = view.normals + row * view.normal_stride + 3 * column;
      for (std::size_t axis = 0; axis < 3; ++axis) normal[axis] = normals[axis][i];
    }
    for (; going != 0; going &= going - 1, ++left) {
      const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(going));
      rays.pixel[left] = rays.pixel[i];
      rays.slices[left] = rays.slices[i];
      for (float* field : {rays.depth, rays.end, rays.direction[0], rays.direction[1], rays.direction[2], rays.sample,
                           rays.before, rays.f_before, rays.behind}) {
        field[left] = field[i];
      }
    }
  }
  return left;
}

}  // namespace saccade
