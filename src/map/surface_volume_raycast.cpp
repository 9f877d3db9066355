#include <algorithm>
#include <cmath>

#include "map/surface_volume_scratch.hpp"
#include "saccade/core/multiversion.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;

// The visible bricks as a dense array; positions are relative to its first brick.
struct Grid {
  const SurfaceBrick* const* bricks;
  std::ptrdiff_t row, slice;  // steps to the next brick in y and z
  int nx, ny, nz;             // bricks, margin included

  [[nodiscard]] const SurfaceBrick* at(int bx, int by, int bz) const { return bricks[bx + by * row + bz * slice]; }
};

struct Sampled {
  float distance = 0.0F;  // share of the band
  float gradient[3] = {0.0F, 0.0F, 0.0F};
  bool known = false;
};

// Distances of the eight samples around a point, the brick boundary in reach of none, one or several of them.
inline bool fetchCorners(const Grid& grid, int x, int y, int z, float* d) {
  const int lx = x & 7, ly = y & 7, lz = z & 7;
  const int bx = x >> 3, by = y >> 3, bz = z >> 3;
  if (lx < 7 && ly < 7 && lz < 7) {
    const SurfaceBrick* brick = grid.at(bx, by, bz);
    if (brick == nullptr) return false;
    const int at = lx + kSide * (ly + kSide * lz);
    constexpr int kSteps[8] = {0, 1, 8, 9, 64, 65, 72, 73};
    bool known = true;
    for (int c = 0; c < 8; ++c) {
      const auto i = static_cast<std::size_t>(at + kSteps[c]);
      d[c] = brick->distance[i];
      known &= brick->weight[i] > 0;
    }
    return known;
  }
  for (int c = 0; c < 8; ++c) {
    const int cx = x + (c & 1), cy = y + ((c >> 1) & 1), cz = z + (c >> 2);
    const SurfaceBrick* brick = grid.at(cx >> 3, cy >> 3, cz >> 3);
    if (brick == nullptr) return false;
    const auto i = static_cast<std::size_t>((cx & 7) + kSide * ((cy & 7) + kSide * (cz & 7)));
    if (brick->weight[i] == 0) return false;
    d[c] = brick->distance[i];
  }
  return true;
}

// Trilinear distance and its gradient (per cell) at a point in cells.
inline Sampled sampleAt(const Grid& grid, float gx, float gy, float gz) {
  Sampled out;
  const float bx = std::floor(gx), by = std::floor(gy), bz = std::floor(gz);
  float d[8];
  if (!fetchCorners(grid, static_cast<int>(bx), static_cast<int>(by), static_cast<int>(bz), d)) return out;
  const float fx = gx - bx, fy = gy - by, fz = gz - bz;
  const float x00 = d[0] + fx * (d[1] - d[0]), x10 = d[2] + fx * (d[3] - d[2]);
  const float x01 = d[4] + fx * (d[5] - d[4]), x11 = d[6] + fx * (d[7] - d[6]);
  const float y0 = x00 + fy * (x10 - x00), y1 = x01 + fy * (x11 - x01);
  constexpr float kPerUnit = 1.0F / SurfaceBrick::kDistanceScale;
  out.distance = (y0 + fz * (y1 - y0)) * kPerUnit;
  const float dx0 = (d[1] - d[0]) + fy * ((d[3] - d[2]) - (d[1] - d[0]));
  const float dx1 = (d[5] - d[4]) + fy * ((d[7] - d[6]) - (d[5] - d[4]));
  out.gradient[0] = (dx0 + fz * (dx1 - dx0)) * kPerUnit;
  out.gradient[1] = ((x10 - x00) + fz * ((x11 - x01) - (x10 - x00))) * kPerUnit;
  out.gradient[2] = (y1 - y0) * kPerUnit;
  out.known = true;
  return out;
}

// One ray: position in cells at depth z is origin + z * direction.
struct Ray {
  float origin[3];
  float direction[3];
  float cells_per_depth;  // length of `direction`
};

struct Hit {
  float depth = 0.0F;  // 0: none
  float gradient[3] = {0.0F, 0.0F, 0.0F};
};

// Depth at which the ray leaves the brick that holds the cell (x, y, z).
inline float leaveBrick(const Ray& ray, int x, int y, int z) {
  float depth = 1e9F;
  const int cell[3] = {x, y, z};
  for (int axis = 0; axis < 3; ++axis) {
    const float direction = ray.direction[axis];
    if (std::abs(direction) < 1e-6F) continue;
    const int edge = (cell[axis] & ~7) + (direction > 0.0F ? kSide : 0);
    depth = std::min(depth, (static_cast<float>(edge) - ray.origin[axis]) / direction);
  }
  return depth;
}

// The surface between a point before it and a later one that is not: secant, then one Newton step along the ray.
inline Hit refine(const Grid& grid, const Ray& ray, float before, float behind, float f_before, float f_behind) {
  Hit hit;
  float z = before + (behind - before) * f_before / (f_before - f_behind);
  const float gx = ray.origin[0] + z * ray.direction[0];
  const float gy = ray.origin[1] + z * ray.direction[1];
  const float gz = ray.origin[2] + z * ray.direction[2];
  const Sampled s = sampleAt(grid, gx, gy, gz);
  if (!s.known) return hit;
  const float slope =
      s.gradient[0] * ray.direction[0] + s.gradient[1] * ray.direction[1] + s.gradient[2] * ray.direction[2];
  if (!(slope < 0.0F)) return hit;  // the surface's back, or no gradient at all
  hit.depth = std::clamp(z - s.distance / slope, before, behind);
  std::copy(s.gradient, s.gradient + 3, hit.gradient);
  return hit;
}

Hit castOne(const Grid& grid, const Ray& ray, float start, float end, float band_cells) {
  const float cell_step = 1.0F / ray.cells_per_depth;  // depth after which the ray is one cell further
  float z = start;
  float z_before = -1.0F;  // depth of the last sample before the surface, -1: none
  while (z < end) {
    const float gx = ray.origin[0] + z * ray.direction[0];
    const float gy = ray.origin[1] + z * ray.direction[1];
    const float gz = ray.origin[2] + z * ray.direction[2];
    const int x = static_cast<int>(gx), y = static_cast<int>(gy), zi = static_cast<int>(gz);  // never negative
    const SurfaceBrick* brick = grid.at(x >> 3, y >> 3, zi >> 3);
    if (brick == nullptr) {
      z = std::max(z + 0.02F * cell_step, leaveBrick(ray, x, y, zi) + 0.01F * cell_step);
      z_before = -1.0F;
      continue;
    }
    const auto i = static_cast<std::size_t>((x & 7) + kSide * ((y & 7) + kSide * (zi & 7)));
    if (brick->weight[i] == 0) {
      z += cell_step;
      z_before = -1.0F;
      continue;
    }
    // The sample below the point differs from the point's own value by at most the diagonal of a cell.
    const float coarse = static_cast<float>(brick->distance[i]) * (band_cells / SurfaceBrick::kDistanceScale);
    if (coarse > 2.0F) {
      z_before = z;
      z += std::max(1.0F, 0.7F * (coarse - 1.0F)) * cell_step;
      continue;
    }
    if (coarse < -2.5F && z_before < 0.0F) {
      z += cell_step;
      continue;
    }
    const Sampled here = sampleAt(grid, gx, gy, gz);
    if (!here.known) {
      z += 0.5F * cell_step;
      z_before = -1.0F;
      continue;
    }
    if (here.distance > 0.0F) {
      z_before = z;
      z += std::max(0.6F, 0.8F * here.distance * band_cells) * cell_step;
      continue;
    }
    if (z_before >= 0.0F) {
      const Sampled before =
          sampleAt(grid, ray.origin[0] + z_before * ray.direction[0], ray.origin[1] + z_before * ray.direction[1],
                   ray.origin[2] + z_before * ray.direction[2]);
      if (before.known && before.distance > 0.0F) {
        const Hit hit = refine(grid, ray, z_before, z, before.distance, here.distance);
        if (hit.depth > 0.0F) return hit;
      }
    }
    z_before = -1.0F;
    z += cell_step;
  }
  return {};
}

}  // namespace

void SurfaceVolume::buildDirectory() const {
  Scratch& s = *scratch_;
  Eigen::Vector3i low = Eigen::Vector3i::Constant(INT32_MAX);
  Eigen::Vector3i high = Eigen::Vector3i::Constant(INT32_MIN);
  for (const std::int32_t index : s.visible) {
    const BrickPosition& p = positions_[static_cast<std::size_t>(index)];
    const Eigen::Vector3i at(p.x, p.y, p.z);
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  s.origin = low - Eigen::Vector3i::Ones();  // a margin on either side: neighbours and rounding stay inside
  s.extent = high - low + Eigen::Vector3i::Constant(3);
  const std::size_t size = static_cast<std::size_t>(s.extent.x()) * static_cast<std::size_t>(s.extent.y()) *
                           static_cast<std::size_t>(s.extent.z());
  if (s.directory.size() < size) s.directory.resize(size, nullptr);
  for (const std::size_t slot : s.filled) s.directory[slot] = nullptr;
  s.filled.clear();
  for (const std::int32_t index : s.visible) {
    const BrickPosition& p = positions_[static_cast<std::size_t>(index)];
    const Eigen::Vector3i at = Eigen::Vector3i(p.x, p.y, p.z) - s.origin;
    const std::size_t slot = static_cast<std::size_t>(at.x()) +
                             static_cast<std::size_t>(s.extent.x()) *
                                 (static_cast<std::size_t>(at.y()) +
                                  static_cast<std::size_t>(s.extent.y()) * static_cast<std::size_t>(at.z()));
    s.directory[slot] = bricks_[static_cast<std::size_t>(index)];
    s.filled.push_back(slot);
  }
}

void SurfaceVolume::boundRays(const PinholeCamera& camera, const Pose&) const {
  Scratch& s = *scratch_;
  const int columns = (camera.width + kRayTile - 1) / kRayTile;
  const int rows = (camera.height + kRayTile - 1) / kRayTile;
  s.nearest_hit.assign(static_cast<std::size_t>(columns * rows), 1e9F);
  s.farthest_hit.assign(static_cast<std::size_t>(columns * rows), 0.0F);
  // The surface of a negative sample may lie a cell outside its brick.
  const auto radius = static_cast<float>((std::sqrt(3.0) / 2.0 * kSide + 1.0) * config_.cell_m);
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  for (std::size_t i = 0; i < s.visible.size(); ++i) {
    if (behind_[static_cast<std::size_t>(s.visible[i])] == 0) continue;
    const Eigen::Vector3f& c = s.centres[i];
    const float z = std::max(c.z() - radius, 0.02F);
    const float far = c.z() + radius;
    int u0 = 0, u1 = columns - 1, v0 = 0, v1 = rows - 1;
    if (c.z() > 2.0F * radius) {
      const float u = fx * c.x() / c.z() + static_cast<float>(camera.cx);
      const float v = fy * c.y() / c.z() + static_cast<float>(camera.cy);
      const float spread_u = fx * radius / z * (1.0F + std::abs(c.x()) / c.z()) + 1.0F;
      const float spread_v = fy * radius / z * (1.0F + std::abs(c.y()) / c.z()) + 1.0F;
      const auto tile = [](float pixel) { return static_cast<int>(std::floor(pixel / kRayTile)); };
      u0 = std::max(u0, tile(u - spread_u));
      u1 = std::min(u1, tile(u + spread_u));
      v0 = std::max(v0, tile(v - spread_v));
      v1 = std::min(v1, tile(v + spread_v));
    }
    for (int row = v0; row <= v1; ++row) {
      for (int column = u0; column <= u1; ++column) {
        const auto t = static_cast<std::size_t>(row * columns + column);
        s.nearest_hit[t] = std::min(s.nearest_hit[t], z);
        s.farthest_hit[t] = std::max(s.farthest_hit[t], far);
      }
    }
  }
}

void SurfaceVolume::rayCast(const PinholeCamera& camera, const Pose& T_WM, ModelView& view) const {
  requireUsablePose(T_WM, "T_WM");
  view.camera = camera;
  view.T_WM = T_WM;
  view.depth_m.create(camera.height, camera.width);
  view.normals.create(camera.height, camera.width);
  view.depth_m.setTo(0.0F);
  view.normals.setTo(cv::Scalar::all(0.0));
  findVisible(camera, T_WM);
  if (scratch_->visible.empty()) return;
  buildDirectory();
  boundRays(camera, T_WM);

  const Scratch& s = *scratch_;
  const Grid grid{s.directory.data(), s.extent.x(), static_cast<std::ptrdiff_t>(s.extent.x()) * s.extent.y(),
                  s.extent.x(),       s.extent.y(), s.extent.z()};
  const Eigen::Matrix3f R = (T_WM.linear() / config_.cell_m).cast<float>();
  const Eigen::Matrix3f R_MW = T_WM.linear().transpose().cast<float>();
  const Eigen::Vector3f origin =
      (T_WM.translation() / config_.cell_m - (s.origin * kSide).cast<double>()).cast<float>();
  const auto band_cells = static_cast<float>(config_.band_cells);
  const int columns = (camera.width + kRayTile - 1) / kRayTile;
  const auto max_range = static_cast<float>(config_.max_range_m);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto tile = static_cast<std::size_t>((v / kRayTile) * columns + u / kRayTile);
      if (s.farthest_hit[tile] <= 0.0F) continue;
      const Eigen::Vector3f direction = R * camera.unproject(u, v, 1.0).cast<float>();
      float start = s.nearest_hit[tile], end = std::min(s.farthest_hit[tile], max_range);
      // Stay inside the directory, less the margin.
      for (int axis = 0; axis < 3; ++axis) {
        const float low = 1.0F, high = static_cast<float>(s.extent[axis] * kSide) - 9.0F;
        if (std::abs(direction[axis]) < 1e-6F) {
          if (origin[axis] < low || origin[axis] > high) end = 0.0F;
          continue;
        }
        const float a = (low - origin[axis]) / direction[axis], b = (high - origin[axis]) / direction[axis];
        start = std::max(start, std::min(a, b));
        end = std::min(end, std::max(a, b));
      }
      if (!(start < end)) continue;
      const Ray ray{
          {origin.x(), origin.y(), origin.z()}, {direction.x(), direction.y(), direction.z()}, direction.norm()};
      const Hit hit = castOne(grid, ray, start, end, band_cells);
      if (hit.depth <= 0.0F) continue;
      const Eigen::Vector3f normal =
          (R_MW * Eigen::Vector3f(hit.gradient[0], hit.gradient[1], hit.gradient[2])).normalized();
      view.depth_m(v, u) = hit.depth;
      view.normals(v, u) = {normal.x(), normal.y(), normal.z()};
    }
  }
}

}  // namespace saccade
