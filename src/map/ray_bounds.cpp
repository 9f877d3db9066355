#include "map/ray_bounds.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr float kNever = 1e9F;
// Blocks nearer than this have no useful bounds in the image.
constexpr float kNearest_m = 0.02F;
constexpr int kSlices = 32;  // bits of a word

// Extends the bounds of `count` cells from `nearest` and `slices` on; reaches kLanes cells.
SACCADE_INLINE void extend(float* nearest, std::int32_t* slices, int count, float near, std::int32_t bits) {
  const IntLanes lane = {0, 1, 2, 3, 4, 5, 6, 7};
  for (int first = 0; first < count; first += kLanes) {
    const IntLanes in = lane < count - first;
    const FloatLanes n = loadLanes(nearest + first);
    storeLanes(in & (n > near) ? allLanes(near) : n, nearest + first);
    storeLanes(loadLanes(slices + first) | (in & bits), slices + first);
  }
}

}  // namespace

void RayBounds::reset(const PinholeCamera& camera, const Eigen::Matrix3f& R_CW, float sample_m, float max_range_m) {
  Constants& c = constants_;
  c.fx = static_cast<float>(camera.fx);
  c.fy = static_cast<float>(camera.fy);
  c.cx = static_cast<float>(camera.cx);
  c.cy = static_cast<float>(camera.cy);
  c.last_u = static_cast<float>(camera.width - 1);
  c.last_v = static_cast<float>(camera.height - 1);
  c.sample = sample_m;
  c.half = 1.5F * sample_m;  // half a sample to its samples, and one to the surface
  c.half_deep = c.half * R_CW.row(2).cwiseAbs().sum();
  c.lead = 0.25F * sample_m;
  c.per_slice = static_cast<float>(kSlices) / (1.01F * max_range_m);
  for (int i = 0; i < 9; ++i) c.R_CW[static_cast<std::size_t>(i)] = R_CW(i / 3, i % 3);
  for (int block = 0; block < 64; ++block) {
    const Eigen::Vector3f at = R_CW * (Eigen::Vector3i(block & 3, block >> 2 & 3, block >> 4).cast<float>() * 2.0F -
                                       Eigen::Vector3f::Constant(3.0F));
    for (int axis = 0; axis < 3; ++axis) {
      c.offset[static_cast<std::size_t>(axis)][static_cast<std::size_t>(block)] = at[axis] * sample_m;
    }
  }
  stride_ = (camera.width + kCellPixels - 1) / kCellPixels + 2 * kLanes;
  rows_ = (camera.height + kCellPixels - 1) / kCellPixels;
  nearest_.assign(static_cast<std::size_t>(stride_ * rows_), kNever);
  slices_.assign(static_cast<std::size_t>(stride_ * rows_), 0);
  is_limited_ = false;
}

void RayBounds::limitTo(const cv::Mat1b& wanted) {
  is_limited_ = true;
  const auto stride = static_cast<std::size_t>(stride_);
  wanted_before_.assign(stride * static_cast<std::size_t>(rows_ + 1), 0);
  for (int v = 0; v < wanted.rows; ++v) {
    std::int32_t* below = wanted_before_.data() + static_cast<std::size_t>(v / kCellPixels + 1) * stride;
    for (int u = 0; u < wanted.cols; ++u) below[u / kCellPixels + 1] |= wanted(v, u) != 0 ? 1 : 0;
  }
  for (int row = 0; row < rows_; ++row) {
    const std::int32_t* above = wanted_before_.data() + static_cast<std::size_t>(row) * stride;
    std::int32_t* below = wanted_before_.data() + static_cast<std::size_t>(row + 1) * stride;
    std::int32_t in_row = 0;
    for (int column = 1; column < stride_; ++column) below[column] = above[column] + (in_row += below[column]);
  }
}

/// Whether a block of the brick may be drawn to a cell that is wanted.
bool RayBounds::isWanted(const Eigen::Vector3f& centre_C) const {
  const Constants& c = constants_;
  const float block_away = 3.0F * std::sqrt(3.0F) * c.sample, corner_away = std::sqrt(3.0F) * c.half;
  const float near = centre_C.z() - block_away - corner_away;
  if (near <= kNearest_m) return true;
  // By how much x / z changes to a block's centre, and from there on to what draw() takes for its cube's reach.
  const float change = block_away + corner_away * (1.0F + block_away / near);
  const auto cells = [&](float f, float centre, float last, float x, int* ends) {
    constexpr float kRounding_px = 2.0F;
    const float t = x / centre_C.z(), at = f * t + centre;
    const float reach = f * std::sqrt(1.0F + t * t) * change / near + kRounding_px;
    if (at + reach < 0.0F || at - reach > last) return false;
    ends[0] = static_cast<int>(std::max(at - reach, 0.0F)) / kCellPixels;
    ends[1] = static_cast<int>(std::min(at + reach, last)) / kCellPixels + 1;
    return true;
  };
  int u[2], v[2];
  if (!cells(c.fx, c.cx, c.last_u, centre_C.x(), u) || !cells(c.fy, c.cy, c.last_v, centre_C.y(), v)) return false;
  const auto before = [&](int row, int column) {
    return wanted_before_[static_cast<std::size_t>(row * stride_ + column)];
  };
  return before(v[1], u[1]) - before(v[0], u[1]) - before(v[1], u[0]) + before(v[0], u[0]) > 0;
}

void RayBounds::add(const Eigen::Vector3f& centre_C, std::uint64_t blocks) {
  if (is_limited_ && !isWanted(centre_C)) return;
  draw(constants_, centre_C.data(), blocks, stride_, rows_, nearest_.data(), slices_.data());
}

SACCADE_MULTIVERSION
void RayBounds::draw(const Constants& c, const float* centre, std::uint64_t blocks, int stride, int rows,
                     float* nearest, std::int32_t* slices) {
  const FloatLanes zero = {};
  for (std::size_t first = 0; first < 64; first += kLanes) {
    auto wanted = static_cast<unsigned>(blocks >> first & 0xFFU);
    if (wanted == 0) continue;
    const FloatLanes x = loadLanes(&c.offset[0][first]) + centre[0];
    const FloatLanes y = loadLanes(&c.offset[1][first]) + centre[1];
    const FloatLanes z = loadLanes(&c.offset[2][first]) + centre[2];
    const FloatLanes near = z - c.half_deep, far = z + c.half_deep;
    // A corner p + d of the block's cube has x / z = p.x / p.z + (d.x - (p.x / p.z) d.z) / (p.z + d.z).
    const FloatLanes per_z = 1.0F / z, per_near = c.half / near;
    const FloatLanes tx = x * per_z, ty = y * per_z;
    const FloatLanes reach_x = magnitude(c.R_CW[0] - tx * c.R_CW[6]) + magnitude(c.R_CW[1] - tx * c.R_CW[7]) +
                               magnitude(c.R_CW[2] - tx * c.R_CW[8]);
    const FloatLanes reach_y = magnitude(c.R_CW[3] - ty * c.R_CW[6]) + magnitude(c.R_CW[4] - ty * c.R_CW[7]) +
                               magnitude(c.R_CW[5] - ty * c.R_CW[8]);
    const FloatLanes u = c.fx * tx + c.cx, v = c.fy * ty + c.cy;
    const FloatLanes du = c.fx * reach_x * per_near, dv = c.fy * reach_y * per_near;
    const FloatLanes last_u = allLanes(c.last_u), last_v = allLanes(c.last_v);
    // First pixel rounded up, last one down; numbers too large for an int do not get there.
    const IntLanes u0 = truncated(least(most(u - du + 0.999F, zero), last_u + 1.0F));
    const IntLanes u1 = truncated(least(most(u + du, zero - 1.0F), last_u));
    const IntLanes v0 = truncated(least(most(v - dv + 0.999F, zero), last_v + 1.0F));
    const IntLanes v1 = truncated(least(most(v + dv, zero - 1.0F), last_v));
    const FloatLanes begin = near - c.lead, last_slice = allLanes(static_cast<float>(kSlices - 1));
    const IntLanes first_slice = truncated(least(most(begin * c.per_slice, zero), last_slice));
    const IntLanes end_slice = truncated(least(most(far * c.per_slice, zero), last_slice));
    for (; wanted != 0; wanted &= wanted - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(wanted));
      if (far[i] <= 0.0F) continue;
      const auto bits = static_cast<std::int32_t>((2U << end_slice[i]) - (1U << first_slice[i]));
      if (near[i] <= kNearest_m) {
        for (int row = 0; row < rows; ++row) {
          extend(nearest + row * stride, slices + row * stride, stride - kLanes, kNearest_m, bits);
        }
        continue;
      }
      if (u0[i] > u1[i] || v0[i] > v1[i]) continue;
      const int column = u0[i] / kCellPixels, count = u1[i] / kCellPixels - column + 1;
      for (int row = v0[i] / kCellPixels; row <= v1[i] / kCellPixels; ++row) {
        const int at = row * stride + column;
        extend(nearest + at, slices + at, count, begin[i], bits);
      }
    }
  }
}

}  // namespace saccade
