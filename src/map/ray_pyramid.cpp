#include "map/ray_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

/// Cells beyond which the margin does not grow, however near the surface.
constexpr int kLargestMargin = 32;

/// Smallest depth of the points (x, y, z), of which there are `count`.
SACCADE_MULTIVERSION float nearestDepth(const float* x, const float* y, const float* z, std::size_t count,
                                        const EndProjection& p) {
  // Of the last points, fewer than lanes, some are looked at twice.
  FloatLanes nearest = allLanes(3.0e38f);
  const std::size_t last = count < kLanes ? 0 : count - kLanes;
  for (std::size_t i = 0; count >= kLanes && i < count; i += kLanes) {
    const std::size_t k = std::min(i, last);
    nearest =
        least(nearest, p.R_CW[6] * (loadLanes(x + k) - p.camera[0]) + p.R_CW[7] * (loadLanes(y + k) - p.camera[1]) +
                           p.R_CW[8] * (loadLanes(z + k) - p.camera[2]));
  }
  float each[kLanes];
  storeLanes(nearest, each);
  float result = *std::min_element(each, each + kLanes);
  for (std::size_t i = 0; count < kLanes && i < count; ++i) {
    result = std::min(
        result, p.R_CW[6] * (x[i] - p.camera[0]) + p.R_CW[7] * (y[i] - p.camera[1]) + p.R_CW[8] * (z[i] - p.camera[2]));
  }
  return result;
}

/// Inverse components of the vectors from the camera to the points, their depths and cells.
SACCADE_MULTIVERSION void projectEnds(const float* x, const float* y, const float* z, std::size_t count,
                                      const EndProjection& projection, float* __restrict inverse_x,
                                      float* __restrict inverse_y, float* __restrict inverse_z, float* __restrict depth,
                                      std::int32_t* __restrict cell, std::int32_t* __restrict place) {
  const EndProjection p = projection;  // a copy, which what is written cannot change
  constexpr float kSmallest = 1e-6f;   // keeps rays along a plane of leaf walls free of 0 * infinity
  const auto inverse = [](float component) {
    const float magnitude = std::fabs(component) < kSmallest ? kSmallest : std::fabs(component);
    return 1.0f / std::copysign(magnitude, component);
  };
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - p.camera[0], dy = y[i] - p.camera[1], dz = z[i] - p.camera[2];
    const float px = p.R_CW[0] * dx + p.R_CW[1] * dy + p.R_CW[2] * dz;
    const float py = p.R_CW[3] * dx + p.R_CW[4] * dy + p.R_CW[5] * dz;
    const float far = p.R_CW[6] * dx + p.R_CW[7] * dy + p.R_CW[8] * dz;
    const float pz = far > 1e-3f ? far : 1e-3f;
    const float u = p.fx * px / pz + p.cx, v = p.fy * py / pz + p.cy;
    const float column = u < 0.0f ? 0.0f : u > p.last_x ? p.last_x : u;
    const float row = v < 0.0f ? 0.0f : v > p.last_y ? p.last_y : v;
    const auto cell_x = static_cast<std::int32_t>(column), cell_y = static_cast<std::int32_t>(row);
    cell[i] = cell_y * p.width + cell_x;
    place[i] = (cell_y & ~1) * p.width + 2 * cell_x + (cell_y & 1);
    depth[i] = pz;
    inverse_x[i] = inverse(dx);
    inverse_y[i] = inverse(dy);
    inverse_z[i] = inverse(dz);
  }
}

/// Rays tested together: a row of the box is rounded up to these, with rays of the cells beside it.
constexpr std::size_t kBatch = kLanes;

/// Inverse vectors of the rays, one component in each array.
struct Inverses {
  const float *x, *y, *z;
};

/// Bits of the family's leaves that some of eight rays from `k` on cross: per axis the shares of a ray's length at
/// which it enters and leaves the lower and the upper half, then the eight combinations.
SACCADE_INLINE void crossLeaves(const Inverses& rays, std::uint32_t k, const float* low, IntLanes& crossed) {
  const FloatLanes start = {}, end_of_ray = allLanes(1.0f);  // shares of a ray
  const FloatLanes step_x = loadLanes(rays.x + k), step_y = loadLanes(rays.y + k), step_z = loadLanes(rays.z + k);
  const FloatLanes x0 = low[0] * step_x, x1 = x0 + step_x, x2 = x1 + step_x;
  const FloatLanes y0 = low[1] * step_y, y1 = y0 + step_y, y2 = y1 + step_y;
  const FloatLanes z0 = low[2] * step_z, z1 = z0 + step_z, z2 = z1 + step_z;
  const FloatLanes in_x0 = most(least(x0, x1), start), in_x1 = most(least(x1, x2), start);
  const FloatLanes out_x0 = least(most(x0, x1), end_of_ray), out_x1 = least(most(x1, x2), end_of_ray);
  const FloatLanes in_y0 = least(y0, y1), in_y1 = least(y1, y2);
  const FloatLanes out_y0 = most(y0, y1), out_y1 = most(y1, y2);
  const FloatLanes in_z0 = least(z0, z1), in_z1 = least(z1, z2);
  const FloatLanes out_z0 = most(z0, z1), out_z1 = most(z1, z2);
  const FloatLanes in_00 = most(in_x0, in_y0), in_10 = most(in_x1, in_y0);
  const FloatLanes in_01 = most(in_x0, in_y1), in_11 = most(in_x1, in_y1);
  const FloatLanes out_00 = least(out_x0, out_y0), out_10 = least(out_x1, out_y0);
  const FloatLanes out_01 = least(out_x0, out_y1), out_11 = least(out_x1, out_y1);
  crossed |= ((most(in_00, in_z0) < least(out_00, out_z0)) & 1) | ((most(in_10, in_z0) < least(out_10, out_z0)) & 2) |
             ((most(in_01, in_z0) < least(out_01, out_z0)) & 4) | ((most(in_11, in_z0) < least(out_11, out_z0)) & 8) |
             ((most(in_00, in_z1) < least(out_00, out_z1)) & 16) | ((most(in_10, in_z1) < least(out_10, out_z1)) & 32) |
             ((most(in_01, in_z1) < least(out_01, out_z1)) & 64) | ((most(in_11, in_z1) < least(out_11, out_z1)) & 128);
}

/// Whether some of eight rays from `k` on cross the family as a whole.
SACCADE_INLINE bool enter(const Inverses& rays, std::uint32_t k, const float* low) {
  const FloatLanes start = {}, end_of_ray = allLanes(1.0f);
  const FloatLanes step_x = loadLanes(rays.x + k), step_y = loadLanes(rays.y + k), step_z = loadLanes(rays.z + k);
  const FloatLanes x0 = low[0] * step_x, x2 = x0 + step_x + step_x;
  const FloatLanes y0 = low[1] * step_y, y2 = y0 + step_y + step_y;
  const FloatLanes z0 = low[2] * step_z, z2 = z0 + step_z + step_z;
  return any(most(most(least(x0, x2), start), most(least(y0, y2), least(z0, z2))) <
             least(least(most(x0, x2), end_of_ray), least(most(y0, y2), most(z0, z2))));
}

/// Bits of the `wanted` leaves of a family that one of the rays of some runs crosses. Run y holds the rays from
/// `first[y * stride]` up to `last[y * stride]`, rounded up to whole batches.
SACCADE_MULTIVERSION unsigned crossedBy(const Inverses& rays, const std::uint32_t* first, const std::uint32_t* last,
                                        std::size_t runs, std::size_t stride, const float* low, unsigned wanted) {
  // First which batches enter the family at all: half of the families that are asked for are entered by none, and of
  // those before a surface the first batches cross all leaves. Of many runs the one through the middle comes first:
  // where nothing is in the way, its rays alone cross all leaves.
  constexpr std::size_t kMostEntering = 64, kManyRuns = 3;
  std::uint32_t entering[kMostEntering];
  std::size_t count = 0;
  IntLanes crossed = {};
  const std::size_t middle = runs >= kManyRuns ? runs / 2 : runs;
  if (middle < runs) {
    for (std::uint32_t k = first[middle * stride]; k < last[middle * stride]; k += kBatch) {
      crossLeaves(rays, k, low, crossed);
    }
    if ((orOf(crossed) & wanted) == wanted) return wanted;
  }
  for (std::size_t run = 0; run < runs; ++run) {
    if (run == middle) continue;
    for (std::uint32_t k = first[run * stride]; k < last[run * stride]; k += kBatch) {
      entering[count] = k;
      count += static_cast<std::size_t>(enter(rays, k, low));
      if (count < kMostEntering) continue;
      for (const std::uint32_t batch : entering) crossLeaves(rays, batch, low, crossed);
      if ((orOf(crossed) & wanted) == wanted) return wanted;
      count = 0;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    crossLeaves(rays, entering[i], low, crossed);
    if ((orOf(crossed) & wanted) == wanted) break;
  }
  return orOf(crossed) & wanted;
}

}  // namespace

SACCADE_MULTIVERSION RayPyramid::Sights RayPyramid::sights(const Level* levels, const float* farthest_ends,
                                                           const SiblingBounds& siblings, unsigned asked) {
  Sights sights;
  const IntLanes lane = {0, 1, 2, 3, 4, 5, 6, 7};
  // Whether no ray of the box, at most eight cells wide, ends behind `near`.
  const auto allEndBefore = [&](std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1, float near) {
    const std::int32_t width = levels[0].width;
    const float* row = farthest_ends + static_cast<std::ptrdiff_t>(y0) * width + x0;
    FloatLanes farthest = {};
    for (std::int32_t y = y0; y <= y1; ++y, row += width) farthest = most(farthest, loadLanes(row));
    return !any((farthest > near) & (lane <= x1 - x0));
  };
  for (; asked != 0; asked &= asked - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(asked));
    const std::int32_t x0 = siblings.x0[i], y0 = siblings.y0[i], x1 = siblings.x1[i], y1 = siblings.y1[i];
    // The finest level on which the box is at most four blocks wide and high.
    const auto extent = static_cast<unsigned>(std::max(x1 - x0, y1 - y0));
    const int level = extent <= 2 ? 0 : std::bit_width(extent / 3);
    const Level& l = levels[level];
    const std::int32_t first_x = x0 >> level;
    const IntLanes in_box = lane < 2 * ((x1 >> level) - first_x + 1);
    const std::int32_t first_block = (y0 >> level) * l.width + first_x;
    const float* row = &l.blocks[static_cast<std::size_t>(first_block)].minus_lowest;
    FloatLanes bounds = {-3.0e38f, 0, -3.0e38f, 0, -3.0e38f, 0, -3.0e38f, 0};
    const FloatLanes none = bounds;
    for (std::int32_t y = y0 >> level; y <= y1 >> level; ++y, row += 2 * l.width) {
      bounds = most(bounds, in_box ? loadLanes(row) : none);
    }
    alignas(32) float b[kLanes];
    storeLanes(bounds, b);
    const float minus_lowest = std::max(std::max(b[0], b[2]), std::max(b[4], b[6]));
    const float highest = std::max(std::max(b[1], b[3]), std::max(b[5], b[7]));
    bool hidden = highest <= siblings.near[i];
    const bool free = !hidden && -minus_lowest > siblings.far[i];
    // Of what straddles, much lies behind the surface with only a block that it hardly touches reaching farther.
    if (level > 0 && !hidden && !free && extent < kLanes) hidden = allEndBefore(x0, y0, x1, y1, siblings.near[i]);
    sights.hidden |= static_cast<unsigned>(hidden) << i;
    sights.free |= static_cast<unsigned>(free) << i;
  }
  sights.free &= ~siblings.clipped;
  return sights;
}

unsigned RayPyramid::crossedLeaves(const SiblingBounds& bounds, unsigned i, const float* low, unsigned wanted) const {
  const std::int32_t first_y = bounds.y0[i] & ~1;
  const std::uint32_t* first = &starts_[placeOf(bounds.x0[i], first_y)];
  const std::uint32_t* last = first + 2 * (bounds.x1[i] - bounds.x0[i] + 1);
  return crossedBy({inverse_x_.data(), inverse_y_.data(), inverse_z_.data()}, first, last,
                   static_cast<std::size_t>(bounds.y1[i] - first_y) / 2 + 1, 2 * static_cast<std::size_t>(width_), low,
                   wanted);
}

unsigned RayPyramid::crossedLeaves(const float* low, unsigned wanted) const {
  const std::uint32_t begin = 0, end = static_cast<std::uint32_t>(ray_count_);
  return crossedBy({inverse_x_.data(), inverse_y_.data(), inverse_z_.data()}, &begin, &end, 1, 0, low, wanted);
}

void RayPyramid::build(const EndpointLeaves& endpoints, const WorkingDepth& depth, const PinholeCamera& camera,
                       const Eigen::Matrix3f& R_CW, const FrameCube& cube) {
  EndProjection projection{};
  for (std::size_t i = 0; i < 3; ++i) projection.camera[i] = cube.camera_leaves[static_cast<Eigen::Index>(i)];
  for (int i = 0; i < 9; ++i) projection.R_CW[i] = R_CW(i / 3, i % 3);
  const auto& [x, y, z] = endpoints.centres();
  const float nearest = nearestDepth(x.data(), y.data(), z.data(), x.size(), projection);
  // Half a leaf's diagonal, as it looks at the nearest point.
  const double pixels = 0.87 * std::max(camera.fx, camera.fy) / std::max(1.0, static_cast<double>(nearest));
  margin_ = std::min(kLargestMargin, static_cast<int>(pixels / 2.0) + 1);
  width_ = (camera.width + 1) / 2 + 2 * margin_;
  height_ = (camera.height + 1) / 2 + 2 * margin_;
  if (levels_.empty()) levels_.emplace_back();
  levels_[0].width = width_;
  levels_[0].height = height_;
  levels_[0].blocks.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + kLanes, Range{0, 0});
  boundPixels(depth);
  projectRays(endpoints, camera, projection);
  groupRays();
  buildLevels();
}

void RayPyramid::boundPixels(const WorkingDepth& depth) {
  for (int y = 0; 2 * y < depth.height(); ++y) {
    const float* a = depth.row(2 * y);
    const float* b = depth.row(std::min(2 * y + 1, depth.height() - 1));
    Range* out = &levels_[0].blocks[static_cast<std::size_t>(y + margin_) * static_cast<std::size_t>(width_) +
                                    static_cast<std::size_t>(margin_)];
    for (int x = 0; 2 * x + 1 < depth.width(); ++x) {
      out[x].minus_lowest = -std::min(std::min(a[2 * x], a[2 * x + 1]), std::min(b[2 * x], b[2 * x + 1]));
    }
  }
}

void RayPyramid::projectRays(const EndpointLeaves& endpoints, const PinholeCamera& camera, EndProjection& projection) {
  projection.fx = static_cast<float>(0.5 * camera.fx);
  projection.fy = static_cast<float>(0.5 * camera.fy);
  projection.cx = static_cast<float>(0.5 * camera.cx + 0.25 + margin_);
  projection.cy = static_cast<float>(0.5 * camera.cy + 0.25 + margin_);
  projection.last_x = static_cast<float>(width_) - 1.0f;
  projection.last_y = static_cast<float>(height_) - 1.0f;
  projection.width = width_;
  Projected& p = projected_;
  const auto& [x, y, z] = endpoints.centres();
  ray_count_ = x.size();
  for (auto* values : {&p.inverse_x, &p.inverse_y, &p.inverse_z, &p.depth}) values->resize(ray_count_);
  p.cell.resize(ray_count_);
  p.place.resize(ray_count_);
  projectEnds(x.data(), y.data(), z.data(), ray_count_, projection, p.inverse_x.data(), p.inverse_y.data(),
              p.inverse_z.data(), p.depth.data(), p.cell.data(), p.place.data());
}

/// Sorts the projected rays by cells.
void RayPyramid::groupRays() {
  starts_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>((height_ + 1) & ~1) + 1, 0);
  farthest_ends_.assign(levels_[0].blocks.size(), 0.0f);
  const Projected& p = projected_;
  for (std::size_t i = 0; i < ray_count_; ++i) {
    ++starts_[static_cast<std::size_t>(p.place[i]) + 1];
    float& farthest = farthest_ends_[static_cast<std::size_t>(p.cell[i])];
    farthest = std::max(farthest, p.depth[i]);
  }
  for (std::size_t cell = 0; cell < farthest_ends_.size(); ++cell)
    levels_[0].blocks[cell].highest = farthest_ends_[cell];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  constexpr float kNever = std::numeric_limits<float>::quiet_NaN();
  for (auto* inverse : {&inverse_x_, &inverse_y_, &inverse_z_}) {
    inverse->resize(ray_count_ + kBatch);
    std::fill(inverse->end() - kBatch, inverse->end(), kNever);
  }
  for (std::size_t i = 0; i < ray_count_; ++i) {
    const std::uint32_t place = starts_[static_cast<std::size_t>(p.place[i])]++;  // moves every start to its end
    inverse_x_[place] = p.inverse_x[i];
    inverse_y_[place] = p.inverse_y[i];
    inverse_z_[place] = p.inverse_z[i];
  }
  for (std::size_t i = starts_.size() - 1; i > 0; --i) starts_[i] = starts_[i - 1];
  starts_[0] = 0;
}

void RayPyramid::buildLevels() {
  std::size_t count = 1;
  for (int w = width_, h = height_; w > 1 || h > 1; ++count) {
    if (levels_.size() <= count) levels_.emplace_back();
    const Level& finer = levels_[count - 1];
    Level& level = levels_[count];
    level.width = (w + 1) / 2;
    level.height = (h + 1) / 2;
    level.blocks.resize(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height) + kLanes);
    for (int y = 0; y < level.height; ++y) {
      const Range* a = &finer.blocks[static_cast<std::size_t>(2 * y) * static_cast<std::size_t>(w)];
      const Range* b = 2 * y + 1 < h ? a + w : a;
      Range* out = &level.blocks[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width)];
      for (int x = 0; x < level.width; ++x) {
        const int l = 2 * x, r = std::min(2 * x + 1, w - 1);
        out[x] = {
            std::max(std::max(a[l].minus_lowest, a[r].minus_lowest), std::max(b[l].minus_lowest, b[r].minus_lowest)),
            std::max(std::max(a[l].highest, a[r].highest), std::max(b[l].highest, b[r].highest))};
      }
    }
    w = level.width;
    h = level.height;
  }
}

}  // namespace saccade
