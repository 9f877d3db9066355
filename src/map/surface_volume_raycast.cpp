#include <algorithm>

#include "core/fill_image.hpp"
#include "core/lanes.hpp"
#include "map/ray_march.hpp"
#include "map/surface_volume_scratch.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;

}  // namespace

/// The visible bricks as a dense array; positions are relative to its first brick.
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
  if (s.directory.size() < size) s.directory.resize(size, &s.unknown);
  s.no_surface.resize(s.directory.size(), 1);
  for (const std::size_t slot : s.filled) {
    s.directory[slot] = &s.unknown;
    s.no_surface[slot] = 1;
  }
  s.filled.clear();
  for (const std::int32_t index : s.visible) {
    const BrickPosition& p = positions_[static_cast<std::size_t>(index)];
    const Eigen::Vector3i at = Eigen::Vector3i(p.x, p.y, p.z) - s.origin;
    const std::size_t slot = static_cast<std::size_t>(at.x()) +
                             static_cast<std::size_t>(s.extent.x()) *
                                 (static_cast<std::size_t>(at.y()) +
                                  static_cast<std::size_t>(s.extent.y()) * static_cast<std::size_t>(at.z()));
    s.directory[slot] = bricks_[static_cast<std::size_t>(index)];
    s.no_surface[slot] = behind_[static_cast<std::size_t>(index)] == 0 ? 1 : 0;
    s.filled.push_back(slot);
  }
}

void SurfaceVolume::boundRays(const PinholeCamera& camera, const Pose& T_WM) const {
  Scratch& s = *scratch_;
  s.bounds.reset(camera, T_WM.linear().transpose().cast<float>(), static_cast<float>(config_.cell_m));
  for (std::size_t i = 0; i < s.visible.size(); ++i) {
    const std::uint64_t blocks = behind_[static_cast<std::size_t>(s.visible[i])];
    if (blocks != 0) s.bounds.add(s.centres[i], blocks);
  }
}

void SurfaceVolume::rayCast(const PinholeCamera& camera, const Pose& T_WM, ModelView& view) const {
  requireUsablePose(T_WM, "T_WM");
  view.camera = camera;
  view.T_WM = T_WM;
  view.depth_m.create(camera.height, camera.width);
  view.normals.create(camera.height, camera.width);
  fillImage(view.depth_m, 0.0F);
  fillImage(view.normals, cv::Vec3f());
  findVisible(camera, T_WM);
  if (scratch_->visible.empty()) return;
  buildDirectory();
  boundRays(camera, T_WM);

  const Scratch& s = *scratch_;
  BrickGrid grid{s.directory.data(), s.no_surface.data(), s.extent.x(), s.extent.x() * s.extent.y(), {}};
  RayRow rays{};
  rays.band_samples = static_cast<float>(config_.band_cells);
  const Eigen::Matrix3d R = T_WM.linear() / config_.cell_m;
  const Eigen::Vector3d origin = T_WM.translation() / config_.cell_m - (s.origin * kSide).cast<double>();
  const Eigen::Vector3d step = R.col(0) / camera.fx;
  for (int axis = 0; axis < 3; ++axis) {
    grid.high[axis] = static_cast<float>(s.extent[axis] * kSide) - 9.0F;
    rays.origin[axis] = static_cast<float>(origin[axis]);
    rays.step[axis] = static_cast<float>(step[axis]);
    for (int k = 0; k < 3; ++k) rays.rotation[3 * axis + k] = static_cast<float>(T_WM.linear()(k, axis));
  }
  const auto max_range = static_cast<float>(config_.max_range_m);
  for (int v = 0; v < camera.height; ++v) {
    const Eigen::Vector3d start = R * camera.unproject(0.0, v, 1.0);
    for (int axis = 0; axis < 3; ++axis) rays.start[axis] = static_cast<float>(start[axis]);
    const float* nearest = s.bounds.nearest(v);
    const float* farthest = s.bounds.farthest(v);
    for (int u = 0; u < camera.width; u += kLanes) {
      alignas(32) float near[kLanes], far[kLanes];
      float reach = 0.0F;
      for (int i = 0; i < kLanes; ++i) {
        const int cell = (u + i) / RayBounds::kCellPixels;
        near[i] = nearest[cell];
        far[i] = u + i < camera.width ? std::min(farthest[cell], max_range) : 0.0F;
        reach = std::max(reach, far[i]);
      }
      if (reach <= 0.0F) continue;
      EightHits hits;
      marchEight(grid, rays, u, near, far, hits);
      for (int i = 0; i < std::min(kLanes, camera.width - u); ++i) {
        view.depth_m(v, u + i) = hits.depth[i];
        view.normals(v, u + i) = {hits.normal[0][i], hits.normal[1][i], hits.normal[2][i]};
      }
    }
  }
}

}  // namespace saccade
