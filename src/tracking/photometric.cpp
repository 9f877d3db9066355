#include "tracking/photometric.hpp"

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

using Points = PhotometricReference::Points;
static_assert(Points::kBlock == ResidualRows::kBlock);

// A surface is the reference's if the live depth is that of the point up to this and this times its square, metres.
constexpr float kSameDepth_m = 0.02F, kSameDepth_per_m = 0.02F;

struct View {
  const float* grey;
  const float* depth;
  int width, height;     // of the level
  int depth_width;       // of the depth image, which is of full resolution
  float fx, fy, cx, cy;  // of the level
  int reduction;         // of the level
  float brightness;
  float gate;
};

struct Transforms {
  float to_live[12];   // T_CR
  float to_model[12];  // T_MR
};

struct BlockPoints {
  const float* p[3];
  const float* slope[3];
  const float* grey;
};

// Of one point in each lane.
struct Vector {
  FloatLanes x, y, z;
};

SACCADE_INLINE void rotate(const float* T, const Vector& from, Vector& to) {
  to.x = T[0] * from.x + T[1] * from.y + T[2] * from.z;
  to.y = T[4] * from.x + T[5] * from.y + T[6] * from.z;
  to.z = T[8] * from.x + T[9] * from.y + T[10] * from.z;
}

SACCADE_INLINE void transform(const float* T, const Vector& from, Vector& to) {
  rotate(T, from, to);
  to.x += T[3];
  to.y += T[7];
  to.z += T[11];
}

SACCADE_MULTIVERSION
void compareBlock(const BlockPoints& points, const Transforms& transforms, const View& view, ResidualRows& rows) {
  const FloatLanes zero = {};
  const float per_gate_square = 1.0F / (view.gate * view.gate);
  const auto u_end = static_cast<float>(view.width - 1), v_end = static_cast<float>(view.height - 1);
  for (std::size_t i = 0; i < ResidualRows::kBlock; i += kLanes) {
    const Vector point{loadLanes(points.p[0] + i), loadLanes(points.p[1] + i), loadLanes(points.p[2] + i)};
    Vector live;
    transform(transforms.to_live, point, live);
    const FloatLanes per_z = 1.0F / live.z;
    const FloatLanes u = view.fx * live.x * per_z + view.cx, v = view.fy * live.y * per_z + view.cy;
    const IntLanes inside = (point.z > zero) & (live.z > 0.05F) & (u >= zero) & (v >= zero) & (u < u_end) & (v < v_end);
    const FloatLanes at_u = inside ? u : zero, at_v = inside ? v : zero;
    const IntLanes column = truncated(at_u), row = truncated(at_v);
    const IntLanes pixel = row * view.width + column;
    const IntLanes full =
        (row * view.reduction + view.reduction / 2) * view.depth_width + column * view.reduction + view.reduction / 2;
    FloatLanes upper_left, upper_right, lower_left, lower_right, seen;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float* grey = view.grey + pixel[lane];
      upper_left[lane] = grey[0];
      upper_right[lane] = grey[1];
      lower_left[lane] = grey[view.width];
      lower_right[lane] = grey[view.width + 1];
      seen[lane] = view.depth[full[lane]];
    }
    const FloatLanes right = at_u - toFloat(column), down = at_v - toFloat(row);
    const FloatLanes upper = upper_left + right * (upper_right - upper_left);
    const FloatLanes lower = lower_left + right * (lower_right - lower_left);
    const FloatLanes residual = upper + down * (lower - upper) - loadLanes(points.grey + i) - view.brightness;
    // Where the live frame has no depth there is no reason to doubt the point.
    const IntLanes same =
        (seen <= zero) | (magnitude(seen - live.z) < kSameDepth_m + kSameDepth_per_m * live.z * live.z);
    const IntLanes met = inside & same;
    const FloatLanes left = 1.0F - residual * residual * per_gate_square;
    const IntLanes counts = met & (left > zero);
    Vector at, slope;
    transform(transforms.to_model, point, at);
    rotate(transforms.to_model,
           {loadLanes(points.slope[0] + i), loadLanes(points.slope[1] + i), loadLanes(points.slope[2] + i)}, slope);
    storeLanes(counts ? at.y * slope.z - at.z * slope.y : zero, rows.j[0] + i);
    storeLanes(counts ? at.z * slope.x - at.x * slope.z : zero, rows.j[1] + i);
    storeLanes(counts ? at.x * slope.y - at.y * slope.x : zero, rows.j[2] + i);
    storeLanes(counts ? slope.x : zero, rows.j[3] + i);
    storeLanes(counts ? slope.y : zero, rows.j[4] + i);
    storeLanes(counts ? slope.z : zero, rows.j[5] + i);
    storeLanes(counts ? residual : zero, rows.residual + i);
    storeLanes(counts ? left * left : zero, rows.weight + i);
    storeLanes(met ? allLanes(1.0F) : zero, rows.met + i);
    storeLanes(counts ? allLanes(1.0F) : zero, rows.near + i);
    storeLanes(counts ? allLanes(1.0F) : zero, rows.inlier + i);
  }
}

void copyRows(const Pose& pose, float* rows) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) rows[4 * row + column] = static_cast<float>(pose.matrix()(row, column));
  }
}

}  // namespace

NormalEquations linearizePhotometric(const PhotometricPair& pair, std::size_t level, const Pose& T_MC,
                                     double brightness, double gate) {
  const IntensityPyramid::Level& live = pair.live.levels[level];
  const PinholeCamera& camera = live.camera;
  const View view{live.grey[0],
                  pair.depth.depth_m[0],
                  live.grey.cols,
                  live.grey.rows,
                  pair.depth.depth_m.cols,
                  static_cast<float>(camera.fx),
                  static_cast<float>(camera.fy),
                  static_cast<float>(camera.cx),
                  static_cast<float>(camera.cy),
                  2 << level,
                  static_cast<float>(brightness),
                  static_cast<float>(gate)};
  Transforms transforms;
  copyRows(T_MC.inverse() * pair.T_MR, transforms.to_live);
  copyRows(pair.T_MR, transforms.to_model);
  const Points& points = pair.reference.points;
  const Points::Level& texture = points.levels[level];
  RowSums sums;
  ResidualRows rows;
  for (std::size_t first = 0; first < points.count; first += Points::kBlock) {
    BlockPoints block{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      block.p[axis] = points.position[axis].data() + first;
      block.slope[axis] = texture.slope[axis].data() + first;
    }
    block.grey = texture.grey.data() + first;
    compareBlock(block, transforms, view, rows);
    sums.add(rows);
  }
  return sums.sums();
}

}  // namespace saccade
