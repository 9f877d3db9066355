#include "tracking/point_to_plane.hpp"

#include <algorithm>
#include <cmath>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr std::size_t kBlock = LivePoints::kBlock;
static_assert(kBlock == ResidualRows::kBlock);

struct Model {
  const float* depth;
  const float* normals;
  int width;
  float u_end, v_end;
  float fx, fy, cx, cy;
  float per_fx, per_fy;
};

struct Gates {
  float distance;
  float cosine;
};

struct BlockPoints {
  const float* p[3];
  const float* n[3];
  const float* weight;
};

SACCADE_MULTIVERSION
void pairBlock(const BlockPoints& points, const float* T, const Model& model, const Gates& gates, ResidualRows& rows) {
  const float* px = points.p[0];
  const float* py = points.p[1];
  const float* pz = points.p[2];
  const float* nx = points.n[0];
  const float* ny = points.n[1];
  const float* nz = points.n[2];
  const float* weights = points.weight;
  const float* depths = model.depth;
  const float* normals = model.normals;
  const int width = model.width;
  const float fx = model.fx, fy = model.fy, cx = model.cx, cy = model.cy;
  const float per_fx = model.per_fx, per_fy = model.per_fy, u_end = model.u_end, v_end = model.v_end;
  const float gate = gates.distance, cosine = gates.cosine;
  const float per_gate_square = 1.0F / (gate * gate);
  const float r00 = T[0], r01 = T[1], r02 = T[2], tx = T[3];
  const float r10 = T[4], r11 = T[5], r12 = T[6], ty = T[7];
  const float r20 = T[8], r21 = T[9], r22 = T[10], tz = T[11];
  const FloatLanes zero = {};
  for (std::size_t i = 0; i < kBlock; i += kLanes) {
    const FloatLanes live_x = loadLanes(px + i), live_y = loadLanes(py + i), live_z = loadLanes(pz + i);
    const FloatLanes x = r00 * live_x + r01 * live_y + r02 * live_z + tx;
    const FloatLanes y = r10 * live_x + r11 * live_y + r12 * live_z + ty;
    const FloatLanes z = r20 * live_x + r21 * live_y + r22 * live_z + tz;
    const FloatLanes weight = loadLanes(weights + i);
    const FloatLanes per_z = 1.0F / z;
    const FloatLanes u = fx * x * per_z + cx + 0.5F, v = fy * y * per_z + cy + 0.5F;
    const IntLanes inside = (z > 0.01F) & (u >= zero) & (v >= zero) & (u < u_end) & (v < v_end) & (weight > zero);
    const IntLanes column = truncated(inside ? u : zero), row = truncated(inside ? v : zero);
    const IntLanes pixel = row * width + column;
    FloatLanes seen = {}, mx = {}, my = {}, mz = {};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float* normal = normals + 3 * pixel[lane];
      seen[lane] = depths[pixel[lane]];
      mx[lane] = normal[0];
      my[lane] = normal[1];
      mz[lane] = normal[2];
    }
    const FloatLanes depth = inside ? seen : zero;
    const FloatLanes dx = (toFloat(column) - cx) * per_fx * depth - x;
    const FloatLanes dy = (toFloat(row) - cy) * per_fy * depth - y;
    const FloatLanes dz = depth - z;
    const FloatLanes residual = mx * dx + my * dy + mz * dz;
    const FloatLanes live_nx = loadLanes(nx + i), live_ny = loadLanes(ny + i), live_nz = loadLanes(nz + i);
    const FloatLanes agreement = mx * (r00 * live_nx + r01 * live_ny + r02 * live_nz) +
                                 my * (r10 * live_nx + r11 * live_ny + r12 * live_nz) +
                                 mz * (r20 * live_nx + r21 * live_ny + r22 * live_nz);
    const FloatLanes square = dx * dx + dy * dy + dz * dz;
    const IntLanes met = depth > zero;
    const IntLanes near = met & (square * per_gate_square < 1.0F);
    const IntLanes paired = near & (agreement > cosine);
    const FloatLanes left = most(zero, 1.0F - residual * residual * per_gate_square);
    storeLanes(paired ? y * mz - z * my : zero, rows.j[0] + i);
    storeLanes(paired ? z * mx - x * mz : zero, rows.j[1] + i);
    storeLanes(paired ? x * my - y * mx : zero, rows.j[2] + i);
    storeLanes(paired ? mx : zero, rows.j[3] + i);
    storeLanes(paired ? my : zero, rows.j[4] + i);
    storeLanes(paired ? mz : zero, rows.j[5] + i);
    storeLanes(paired ? residual : zero, rows.residual + i);
    storeLanes(paired ? weight * left * left : zero, rows.weight + i);
    storeLanes(met ? allLanes(1.0F) : zero, rows.met + i);
    storeLanes(near ? allLanes(1.0F) : zero, rows.near + i);
    storeLanes(paired ? allLanes(1.0F) : zero, rows.inlier + i);
  }
}

}  // namespace

void LivePoints::select(const DepthMaps& depth, int stride) {
  const std::size_t most = static_cast<std::size_t>(depth.camera.width / stride + 1) *
                               static_cast<std::size_t>(depth.camera.height / stride + 1) +
                           kBlock;
  for (auto& axis : position) axis.resize(most);
  for (auto& axis : normal) axis.resize(most);
  weight.resize(most);
  count = 0;
  double range = 0.0;
  for (int v = stride / 2; v < depth.camera.height; v += stride) {
    const cv::Vec3f* vertices = depth.vertices[v];
    const cv::Vec3f* normals = depth.normals[v];
    for (int u = stride / 2; u < depth.camera.width; u += stride) {
      const cv::Vec3f& p = vertices[u];
      const cv::Vec3f& n = normals[u];
      if (n[2] == 0.0F && n[0] == 0.0F && n[1] == 0.0F) continue;
      for (int axis = 0; axis < 3; ++axis) {
        position[static_cast<std::size_t>(axis)][count] = p[axis];
        normal[static_cast<std::size_t>(axis)][count] = n[axis];
      }
      // The sensor's error grows with the square of the depth, along the ray.
      const float sigma = 0.3F + p[2] * p[2];
      weight[count] = 1.0F / (sigma * sigma);
      range += static_cast<double>(p[2]);
      ++count;
    }
  }
  mean_range_m = count > 0 ? range / static_cast<double>(count) : 1.0;
  const std::size_t padded = (count + kBlock - 1) / kBlock * kBlock;
  for (std::size_t i = count; i < padded; ++i) {
    for (auto& axis : position) axis[i] = 1.0F;
    for (auto& axis : normal) axis[i] = 0.0F;
    weight[i] = 0.0F;
  }
}

NormalEquations linearize(const LivePoints& points, const ModelView& model, const Pose& T_MC,
                          const PairingGates& gates) {
  const PinholeCamera& camera = model.camera;
  const Model view{model.depth_m[0],
                   model.normals[0][0].val,
                   camera.width,
                   static_cast<float>(camera.width),
                   static_cast<float>(camera.height),
                   static_cast<float>(camera.fx),
                   static_cast<float>(camera.fy),
                   static_cast<float>(camera.cx),
                   static_cast<float>(camera.cy),
                   static_cast<float>(1.0 / camera.fx),
                   static_cast<float>(1.0 / camera.fy)};
  const Gates limits{static_cast<float>(gates.distance_m), static_cast<float>(gates.normal_cosine)};
  float T[12];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) T[4 * row + column] = static_cast<float>(T_MC.matrix()(row, column));
  }
  RowSums sums;
  ResidualRows rows;
  for (std::size_t first = 0; first < points.count; first += kBlock) {
    const BlockPoints block{
        {points.position[0].data() + first, points.position[1].data() + first, points.position[2].data() + first},
        {points.normal[0].data() + first, points.normal[1].data() + first, points.normal[2].data() + first},
        points.weight.data() + first};
    pairBlock(block, T, view, limits, rows);
    sums.add(rows);
  }
  return sums.sums();
}

Matrix6 noiseFreeInformation(const LivePoints& points, const ModelView& model, const Pose& T_MC,
                             const PairingGates& gates) {
  constexpr std::size_t kStep = 5;  // a fifth of the points: the sum is a mean over thousands of them
  const PinholeCamera& camera = model.camera;
  const Eigen::Isometry3f T = T_MC.cast<float>();
  const auto gate_square = static_cast<float>(gates.distance_m * gates.distance_m);
  Matrix6 sum = Matrix6::Zero();
  double weight = 0.0;
  for (std::size_t i = 0; i < points.count; i += kStep) {
    const Eigen::Vector3f p = T * Eigen::Vector3f(points.position[0][i], points.position[1][i], points.position[2][i]);
    if (!(p.z() > 0.01F)) continue;
    const Eigen::Vector2d pixel = camera.project(p.cast<double>());
    const int u = cvRound(pixel.x()), v = cvRound(pixel.y());
    if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
    const double depth = static_cast<double>(model.depth_m(v, u));
    if (!(depth > 0.0)) continue;
    const Eigen::Vector3f q = camera.unproject(u, v, depth).cast<float>();
    const Eigen::Vector3f expected(model.normals(v, u).val);
    const Eigen::Vector3f live =
        T.linear() * Eigen::Vector3f(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
    if ((q - p).squaredNorm() >= gate_square || expected.dot(live) <= static_cast<float>(gates.normal_cosine)) continue;
    Vector6 of_model, of_live;
    of_model << p.cross(expected).cast<double>(), expected.cast<double>();
    of_live << p.cross(live).cast<double>(), live.cast<double>();
    const auto w = static_cast<double>(points.weight[i]);
    sum += w * (of_model * of_live.transpose());
    weight += w;
  }
  if (!(weight > 0.0)) return Matrix6::Zero();
  return (sum + sum.transpose()) / (2.0 * weight);
}

}  // namespace saccade
