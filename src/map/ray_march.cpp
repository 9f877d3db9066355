#include "map/ray_march.hpp"

#include <cstddef>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;
/// Distances of the eight samples around one point per lane: neighbours along x in one word, the lower one in the
/// lower half; words in the order (y, z) = 00, 10, 01, 11.
struct Corners {
  alignas(32) std::uint32_t pairs[4][kLanes];
  alignas(32) std::int32_t no_surface[kLanes];  // not 0: the point is in no brick, or in one without a surface
};

/// Reads the samples around the points whose lowest neighbour is sample `at` of the brick at `slot`; of lanes that are
/// not open whatever is there.
SACCADE_INLINE void readCorners(const BrickGrid& grid, const IntLanes (&whole)[3], const IntLanes& open,
                                Corners& corners) {
  const IntLanes x = whole[0] & 7, y = whole[1] & 7, z = whole[2] & 7;
  const IntLanes slot = open & ((whole[0] >> 3) + (whole[1] >> 3) * grid.row + (whole[2] >> 3) * grid.slice);
  const IntLanes next_y = (y == 7) & grid.row, next_z = (z == 7) & grid.slice;
  const IntLanes line_y = ((y + 1) & 7) * kSide, line_z = ((z + 1) & 7) * (kSide * kSide);
  alignas(32) std::int32_t slots[4][kLanes], places[4][kLanes], last_x[kLanes];
  storeLanes(slot, slots[0]);
  storeLanes(slot + next_y, slots[1]);
  storeLanes(slot + next_z, slots[2]);
  storeLanes(slot + next_y + next_z, slots[3]);
  storeLanes(x + y * kSide + z * (kSide * kSide), places[0]);
  storeLanes(x + line_y + z * (kSide * kSide), places[1]);
  storeLanes(x + y * kSide + line_z, places[2]);
  storeLanes(x + line_y + line_z, places[3]);
  const IntLanes at_end = x == kSide - 1;
  storeLanes(at_end, last_x);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    corners.no_surface[lane] = grid.no_surface[slots[0][lane]];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto* samples = reinterpret_cast<const std::byte*>(grid.bricks[slots[k][lane]]);
      std::memcpy(&corners.pairs[k][lane], samples + 2 * places[k][lane], 4);
    }
  }
  if (!any(at_end)) return;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (last_x[lane] == 0) continue;
    for (std::size_t k = 0; k < 4; ++k) {  // the upper neighbour is the first of its line in the next brick
      const SurfaceBrick& next = *grid.bricks[slots[k][lane] + 1];
      const auto upper = static_cast<std::uint16_t>(next.distance[static_cast<std::size_t>(places[k][lane] & ~7)]);
      corners.pairs[k][lane] = (corners.pairs[k][lane] & 0xFFFFU) | std::uint32_t{upper} << 16U;
    }
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

}  // namespace

SACCADE_MULTIVERSION
void marchEight(const BrickGrid& grid, const RayRow& rays, int u, const float* near, const float* far,
                EightHits& hits) {
  constexpr float kSmallest = 1e-6F;  // of a direction's component: keeps its inverse finite
  constexpr float kClose_samples = 3.5F, kBeyond_samples = 0.5F, kShortfall = 0.8F;
  constexpr float kBlind_samples = 2.5F;  // on unknown ground: shorter than the known band before a surface
  const FloatLanes column = FloatLanes{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<float>(u);
  FloatLanes direction[3], inverse[3];
  FloatLanes z = loadLanes(near), end = loadLanes(far);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const FloatLanes d = rays.start[axis] + column * rays.step[axis];
    direction[axis] = magnitude(d) < kSmallest ? allLanes(kSmallest) : d;
    inverse[axis] = 1.0F / direction[axis];
    const FloatLanes a = (1.0F - rays.origin[axis]) * inverse[axis];
    const FloatLanes b = (grid.high[axis] - rays.origin[axis]) * inverse[axis];
    z = most(z, least(a, b));
    end = least(end, most(a, b));
  }
  FloatLanes length = direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2];
  squareRoots(length);
  const FloatLanes sample = 1.0F / length;  // depth after which a ray is one sample further

  const FloatLanes zero = {};
  const IntLanes no = {};
  FloatLanes before = zero - 1.0F, f_before = zero;  // last depth before the surface, -1: none; its distance
  FloatLanes behind = zero;                          // depth behind it, while refining
  FloatLanes depth = zero, normal[3] = {zero, zero, zero};
  IntLanes refining = no;
  Corners corners{};
  for (IntLanes open = z < end; any(open); open &= z < end) {
    // Positions are above 0 and so truncation is floor; lanes that are done stay where they were, inside the grid.
    const FloatLanes at = open ? z : zero;
    FloatLanes p[3], fraction[3];
    IntLanes whole[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[axis] = rays.origin[axis] + at * direction[axis];
      whole[axis] = truncated(p[axis]);
      fraction[axis] = p[axis] - toFloat(whole[axis]);
    }
    readCorners(grid, whole, open, corners);
    Sampled here;
    interpolate(corners, fraction[0], fraction[1], fraction[2], here);
    const IntLanes nothing_near = (loadLanes(corners.no_surface) != 0) & ~here.known;
    const IntLanes positive = here.known & (here.distance > zero);
    const IntLanes crossed = here.known & ~positive & (before >= zero) & ~refining;

    // Refined: one Newton step along the ray. From the surface's back, or on unknown ground, the search goes on.
    const FloatLanes slope =
        here.gradient[0] * direction[0] + here.gradient[1] * direction[1] + here.gradient[2] * direction[2];
    const IntLanes hit = open & refining & here.known & (slope < zero);
    const FloatLanes newton = most(before, least(behind, z - here.distance / slope));
    depth = hit ? newton : depth;
    for (std::size_t axis = 0; axis < 3; ++axis) normal[axis] = hit ? here.gradient[axis] : normal[axis];

    // Far from the surface short of it, close to it a little beyond it.
    const FloatLanes samples_away = here.distance * rays.band_samples;
    const FloatLanes stride =
        samples_away < kClose_samples ? samples_away + kBeyond_samples : samples_away * kShortfall;
    const FloatLanes secant = before + (z - before) * f_before / (f_before - here.distance);
    FloatLanes next = z + (positive ? stride : here.known ? allLanes(1.0F) : allLanes(kBlind_samples)) * sample;
    if (any(open & nothing_near)) {  // on to where the ray leaves the brick
      FloatLanes exit = allLanes(1e9F);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const IntLanes edge = (whole[axis] & ~7) + (direction[axis] > zero ? no + kSide : no);
        exit = least(exit, (toFloat(edge) - rays.origin[axis]) * inverse[axis]);
      }
      next = nothing_near ? most(z + 0.02F * sample, exit + 0.01F * sample) : next;
    }
    next = crossed ? secant : next;
    next = refining ? behind + sample : next;
    before = crossed ? before : positive & ~refining ? z : zero - 1.0F;
    f_before = positive ? here.distance : f_before;
    behind = crossed ? z : behind;
    refining = crossed;
    z = hit ? end : next;
  }

  FloatLanes scale = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  squareRoots(scale);
  scale = depth > zero ? 1.0F / scale : zero;
  storeLanes(depth, hits.depth);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* r = rays.rotation + 3 * axis;
    storeLanes((r[0] * normal[0] + r[1] * normal[1] + r[2] * normal[2]) * scale, hits.normal[axis]);
  }
}

}  // namespace saccade
