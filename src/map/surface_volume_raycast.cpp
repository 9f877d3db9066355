#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/fill_image.hpp"
#include "core/lanes.hpp"
#include "map/ray_march.hpp"
#include "map/surface_volume_scratch.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;

}  // namespace

/// The visible bricks as a dense array, and which of them a surface runs through; positions are relative to its first
/// brick.
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
  const auto row = static_cast<std::size_t>(s.extent.x());
  const std::size_t slice = row * static_cast<std::size_t>(s.extent.y());
  const std::size_t size = slice * static_cast<std::size_t>(s.extent.z());
  for (const std::size_t slot : s.filled) s.directory[slot] = &s.unknown;
  for (const std::size_t slot : s.surface) s.copies[slot] = SurfaceGrid::kNoSurface;
  s.filled.clear();
  s.surface.clear();
  if (s.directory.size() < size) {
    s.directory.resize(size, &s.unknown);
    s.copies.resize(size, SurfaceGrid::kNoSurface);
  }
  const auto want = [&s](std::size_t slot) {
    if (s.copies[slot] != SurfaceGrid::kNoSurface) return;
    s.copies[slot] = SurfaceGrid::kNotCopied;
    s.surface.push_back(slot);
  };
  for (const std::int32_t index : s.visible) {
    const BrickPosition& p = positions_[static_cast<std::size_t>(index)];
    const Eigen::Vector3i at = Eigen::Vector3i(p.x, p.y, p.z) - s.origin;
    const std::size_t slot = static_cast<std::size_t>(at.x()) + row * static_cast<std::size_t>(at.y()) +
                             slice * static_cast<std::size_t>(at.z());
    s.directory[slot] = bricks_[static_cast<std::size_t>(index)];
    s.filled.push_back(slot);
    const std::uint64_t blocks = behind_[static_cast<std::size_t>(index)];
    if (blocks == 0) continue;
    // A surface also runs between the brick's first samples and the last ones of its lower neighbours.
    constexpr std::uint64_t kFirstX = 0x1111111111111111U, kFirstY = 0x000F000F000F000FU, kFirstZ = 0xFFFFU;
    for (unsigned lower = 0; lower < 8; ++lower) {
      std::uint64_t touching = blocks;
      if ((lower & 1U) != 0) touching &= kFirstX;
      if ((lower & 2U) != 0) touching &= kFirstY;
      if ((lower & 4U) != 0) touching &= kFirstZ;
      if (touching != 0) want(slot - (lower & 1U) - (lower >> 1U & 1U) * row - (lower >> 2U) * slice);
    }
  }

  s.samples.resize((s.surface.size() + 1) * SurfaceGrid::kCopy + 1);
  std::fill_n(s.samples.data(), SurfaceGrid::kCopy, SurfaceBrick::kUnknownDistance);
}

void SurfaceVolume::boundRays(const PinholeCamera& camera, const Pose& T_WM, const cv::Mat1b* wanted) const {
  Scratch& s = *scratch_;
  s.bounds.reset(camera, T_WM.linear().transpose().cast<float>(), static_cast<float>(config_.cell_m),
                 static_cast<float>(config_.max_range_m));
  if (wanted != nullptr) s.bounds.limitTo(*wanted);
  for (std::size_t i = 0; i < s.visible.size(); ++i) {
    const std::uint64_t blocks = behind_[static_cast<std::size_t>(s.visible[i])];
    if (blocks != 0) s.bounds.add(s.centres[i], blocks);
  }
}

void SurfaceVolume::rayCast(const PinholeCamera& camera, const Pose& T_WM, ModelView& view,
                            const cv::Mat1b* wanted) const {
  requireUsablePose(T_WM, "T_WM");
  if (wanted != nullptr && wanted->size() != cv::Size(camera.width, camera.height)) {
    throw std::invalid_argument("rayCast: the wanted pixels are " + std::to_string(wanted->cols) + " x " +
                                std::to_string(wanted->rows) + ", the camera has " + std::to_string(camera.width) +
                                " x " + std::to_string(camera.height));
  }
  view.camera = camera;
  view.T_WM = T_WM;
  view.depth_m.create(camera.height, camera.width);
  view.normals.create(camera.height, camera.width);
  fillImage(view.depth_m, 0.0F);
  fillImage(view.normals, cv::Vec3f());
  findVisible(camera, T_WM);
  if (scratch_->visible.empty()) return;
  buildDirectory();
  boundRays(camera, T_WM, wanted);

  Scratch& s = *scratch_;
  SurfaceGrid grid{s.directory.data(),
                   s.copies.data(),
                   s.samples.data(),
                   SurfaceGrid::kCopy,
                   s.extent.x(),
                   s.extent.x() * s.extent.y(),
                   {}};
  RayFan fan{};
  fan.slice_m = s.bounds.sliceDepth();
  fan.band_samples = static_cast<float>(config_.band_cells);
  const Eigen::Matrix3d R = T_WM.linear() / config_.cell_m;
  const Eigen::Vector3d origin = T_WM.translation() / config_.cell_m - (s.origin * kSide).cast<double>();
  const Eigen::Vector3d start = R * camera.unproject(0.0, 0.0, 1.0);
  for (int axis = 0; axis < 3; ++axis) {
    grid.high[axis] = static_cast<float>(s.extent[axis] * kSide) - 9.0F;
    fan.origin[axis] = static_cast<float>(origin[axis]);
    fan.start[axis] = static_cast<float>(start[axis]);
    fan.column[axis] = static_cast<float>(R(axis, 0) / camera.fx);
    fan.row[axis] = static_cast<float>(R(axis, 1) / camera.fy);
    for (int k = 0; k < 3; ++k) fan.rotation[3 * axis + k] = static_cast<float>(T_WM.linear()(k, axis));
  }
  const RayQueue::View images{view.depth_m[0], &view.normals(0, 0)[0], view.depth_m.step1(), view.normals.step1()};
  const auto max_range = static_cast<float>(config_.max_range_m);
  constexpr int kRows = 16;  // of pixels whose rays go together: a queue that stays in the cache
  for (int first = 0; first < camera.height; first += kRows) {
    s.rays.reset(static_cast<std::size_t>(kRows) * static_cast<std::size_t>(camera.width));
    for (int v = first; v < std::min(first + kRows, camera.height); ++v) {
      const float* nearest = s.bounds.nearest(v);
      const std::int32_t* slices = s.bounds.slices(v);
      const std::uint8_t* wanted_row = wanted != nullptr ? (*wanted)[v] : nullptr;
      for (int u = 0; u < camera.width; ++u) {
        const int cell = u / RayBounds::kCellPixels;
        if (wanted_row != nullptr && wanted_row[u] == 0) continue;
        s.rays.add(u, v, nearest[cell], slices[cell]);
      }
    }
    s.rays.march(grid, fan, max_range, images);
  }
}

}  // namespace saccade
