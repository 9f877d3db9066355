#include "map/sibling_bounds.hpp"

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

/// Leaves in front of the camera within which a node has no useful bounds in the image.
constexpr float kNoBound = 1e-2f;

}  // namespace

SACCADE_MULTIVERSION void boundSiblings(const ProjectionConstants& c, const SiblingFrame& s, float px, float py,
                                        float pz, SiblingBounds& out) {
  const FloatLanes zero = {};
  const FloatLanes x = px + loadLanes(s.dx.data()), y = py + loadLanes(s.dy.data()), z = pz + loadLanes(s.dz.data());
  const FloatLanes near = z - s.z_reach, far = z + s.z_reach;
  const FloatLanes per_z = 1.0f / z, per_near = s.half / near;
  const FloatLanes tx = x * per_z, ty = y * per_z;
  // |p.x / p.z - tx| over the cube: the numerator p.x - tx p.z is linear, the denominator at least `near`.
  const FloatLanes reach_x = magnitude(c.R_CW[0] - tx * c.R_CW[6]) + magnitude(c.R_CW[1] - tx * c.R_CW[7]) +
                             magnitude(c.R_CW[2] - tx * c.R_CW[8]);
  const FloatLanes reach_y = magnitude(c.R_CW[3] - ty * c.R_CW[6]) + magnitude(c.R_CW[4] - ty * c.R_CW[7]) +
                             magnitude(c.R_CW[5] - ty * c.R_CW[8]);
  const FloatLanes u = c.fx * tx + c.cx, v = c.fy * ty + c.cy;
  const FloatLanes du = c.fx * reach_x * per_near, dv = c.fy * reach_y * per_near;

  const float offset = c.margin_cells + 0.25f;  // pixel u covers [u - 0.5, u + 0.5]
  const FloatLanes x_low = (u - du) * 0.5f + offset, x_high = (u + du) * 0.5f + offset;
  const FloatLanes y_low = (v - dv) * 0.5f + offset, y_high = (v + dv) * 0.5f + offset;
  const FloatLanes width = allLanes(c.width_cells), height = allLanes(c.height_cells);
  const IntLanes x0 = truncated(least(most(x_low, zero), width)), y0 = truncated(least(most(y_low, zero), height));
  const IntLanes x1 = truncated(most(least(x_high + 1.0f, width), zero)) - 1;
  const IntLanes y1 = truncated(most(least(y_high + 1.0f, height), zero)) - 1;

  IntLanes outside = far <= zero;
  for (std::size_t k = 0; k < 4; ++k) {
    outside |= c.planes[3 * k] * x + c.planes[3 * k + 1] * y + c.planes[3 * k + 2] * z < -s.plane_reach[k];
  }
  const IntLanes bounded = near > kNoBound;
  storeLanes(near, out.near.data());
  storeLanes(far, out.far.data());
  storeLanes(x0, out.x0.data());
  storeLanes(y0, out.y0.data());
  storeLanes(x1, out.x1.data());
  storeLanes(y1, out.y1.data());
  out.outside = bitsOf(outside);
  out.bounded = bitsOf(bounded);
  out.empty = bitsOf(bounded & ((x0 > x1) | (y0 > y1)));
  out.clipped = bitsOf((x_low < zero) | (y_low < zero) | (x_high > width) | (y_high > height));
}

}  // namespace saccade
