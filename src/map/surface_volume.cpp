#include "saccade/map/surface_volume.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "map/surface_volume_scratch.hpp"

namespace saccade {
namespace {

constexpr int kSide = SurfaceBrick::kSide;
constexpr std::size_t kSlabBricks = 1024;  // 2 MiB: a slab can be one huge page
constexpr std::size_t kFirstSlots = 1U << 14U;

std::size_t hashOf(const BrickPosition& p) {
  std::uint64_t h = static_cast<std::uint32_t>(p.x) * 0x9E3779B97F4A7C15ULL;
  h ^= static_cast<std::uint32_t>(p.y) * 0xC2B2AE3D27D4EB4FULL;
  h ^= static_cast<std::uint32_t>(p.z) * 0x165667B19E3779F9ULL;
  return static_cast<std::size_t>(h ^ (h >> 29U));
}

}  // namespace

void SurfaceVolumeConfig::describe(ConfigVisitor& visitor) {
  visitor.number("cell_m", cell_m, {0.001, 1.0}, "m", "distance between samples");
  visitor.number("band_cells", band_cells, {2.0, 16.0}, "cells", "truncation of the signed distance");
  visitor.number("weight_cap", weight_cap, {1.0, 500.0}, "observations", "weight at which old observations fade");
  visitor.number("max_range_m", max_range_m, {0.1, 100.0}, "m", "reach of measurements and model views");
  visitor.number("near_weight_m", near_weight_m, {0.1, 100.0}, "m", "distance up to which a measurement counts fully");
}

SurfaceVolume::SurfaceVolume(const Config& config)
    : config_(config), slots_(kFirstSlots, -1), scratch_(std::make_unique<Scratch>()) {
  requireValid(config_);
}
SurfaceVolume::~SurfaceVolume() = default;
SurfaceVolume::SurfaceVolume(SurfaceVolume&&) noexcept = default;
SurfaceVolume& SurfaceVolume::operator=(SurfaceVolume&&) noexcept = default;

std::int32_t SurfaceVolume::find(const BrickPosition& position) const {
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t slot = hashOf(position) & mask;; slot = (slot + 1) & mask) {
    const std::int32_t index = slots_[slot];
    if (index < 0 || positions_[static_cast<std::size_t>(index)] == position) return index;
  }
}

std::int32_t SurfaceVolume::findOrAllocate(const BrickPosition& position) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hashOf(position) & mask;
  while (slots_[slot] >= 0) {
    if (positions_[static_cast<std::size_t>(slots_[slot])] == position) return slots_[slot];
    slot = (slot + 1) & mask;
  }
  const std::size_t index = positions_.size();
  positions_.push_back(position);
  bricks_.push_back(takeRoom());
  last_change_.push_back(changes_);
  behind_.push_back(0);
  slots_[slot] = static_cast<std::int32_t>(index);
  if (2 * positions_.size() > slots_.size()) buildSlots(2 * slots_.size());
  return static_cast<std::int32_t>(index);
}

/// Room for one brick, every sample unknown.
SurfaceBrick* SurfaceVolume::takeRoom() {
  if (free_.empty()) {
    slabs_.push_back(std::make_unique_for_overwrite<SurfaceBrick[]>(kSlabBricks));
    for (std::size_t i = kSlabBricks; i-- > 0;) free_.push_back(&slabs_.back()[i]);
  }
  SurfaceBrick* brick = free_.back();
  free_.pop_back();
  brick->distance.fill(SurfaceBrick::kUnknownDistance);
  brick->weight.fill(0);
  return brick;
}

void SurfaceVolume::buildSlots(std::size_t count) {
  slots_.assign(count, -1);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    std::size_t slot = hashOf(positions_[i]) & mask;
    while (slots_[slot] >= 0) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<std::int32_t>(i);
  }
}

void SurfaceVolume::importBrick(const BrickPosition& position, const SurfaceBrick& brick) {
  ++changes_;
  const auto index = static_cast<std::size_t>(findOrAllocate(position));
  fill(index, brick);
  last_change_[index] = changes_;
}

void SurfaceVolume::fill(std::size_t index, const SurfaceBrick& brick) {
  *bricks_[index] = brick;
  for (std::size_t i = 0; i < brick.weight.size(); ++i) {
    if (brick.weight[i] == 0) bricks_[index]->distance[i] = SurfaceBrick::kUnknownDistance;
  }
  behind_[index] = blocksBehind(*bricks_[index], config_.band_cells);
}

void SurfaceVolume::returnBrick(const BrickPosition& position, const SurfaceBrick& brick) {
  if (find(position) >= 0) throw std::logic_error("SurfaceVolume: a brick that was removed is there again");
  const auto index = static_cast<std::size_t>(findOrAllocate(position));
  fill(index, brick);
  last_change_[index] = 0;
}

void SurfaceVolume::removeBricks(const std::function<bool(std::size_t)>& gone) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (gone(i)) {
      free_.push_back(bricks_[i]);
      continue;
    }
    positions_[kept] = positions_[i];
    bricks_[kept] = bricks_[i];
    last_change_[kept] = last_change_[i];
    behind_[kept] = behind_[i];
    ++kept;
  }
  positions_.resize(kept);
  bricks_.resize(kept);
  last_change_.resize(kept);
  behind_.resize(kept);
  buildSlots(slots_.size());
}

std::size_t SurfaceVolume::memoryBytes() const {
  return slabs_.size() * kSlabBricks * sizeof(SurfaceBrick) + slots_.capacity() * sizeof(slots_[0]) +
         positions_.capacity() * (sizeof(BrickPosition) + sizeof(SurfaceBrick*) + 2 * sizeof(std::uint64_t)) +
         scratch_->directory.capacity() * (sizeof(scratch_->directory[0]) + sizeof(scratch_->copies[0])) +
         scratch_->samples.capacity() * sizeof(scratch_->samples[0]);
}

std::optional<double> SurfaceVolume::distanceAt(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d g = p_W / config_.cell_m;
  const Eigen::Vector3d base = g.array().floor();
  const Eigen::Vector3d f = g - base;
  const Eigen::Vector3i first = base.cast<int>();
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i step(corner & 1, (corner >> 1) & 1, corner >> 2);
    const Eigen::Vector3i at = first + step;
    const std::int32_t index = find({at.x() >> 3, at.y() >> 3, at.z() >> 3});
    if (index < 0) return std::nullopt;
    const SurfaceBrick& brick = *bricks_[static_cast<std::size_t>(index)];
    const auto local = static_cast<std::size_t>((at.x() & 7) + kSide * ((at.y() & 7) + kSide * (at.z() & 7)));
    if (brick.weight[local] == 0) return std::nullopt;
    double share = 1.0;
    for (int axis = 0; axis < 3; ++axis) share *= step[axis] != 0 ? f[axis] : 1.0 - f[axis];
    sum += share * brick.distance[local];
  }
  return sum * config_.band_cells * config_.cell_m / static_cast<double>(SurfaceBrick::kDistanceScale);
}

void SurfaceVolume::findVisible(const PinholeCamera& camera, const Pose& T_WC) const {
  Scratch& s = *scratch_;
  s.visible.clear();
  s.centres.clear();
  const Pose T_CW = T_WC.inverse();
  const Eigen::Matrix3f R = (T_CW.linear() * (kSide * config_.cell_m)).cast<float>();
  const Eigen::Vector3f t = (T_CW * Eigen::Vector3d::Constant((kSide - 1) / 2.0 * config_.cell_m)).cast<float>();
  const auto radius = static_cast<float>(std::sqrt(3.0) / 2.0 * kSide * config_.cell_m);
  const auto farthest = static_cast<float>(config_.max_range_m + config_.band_cells * config_.cell_m) + radius;

  // Side planes of the frustum through the outer edges of the image, as unit vectors (x or y, z).
  const Eigen::Vector2f left = Eigen::Vector2d(camera.fx, camera.cx + 0.5).normalized().cast<float>();
  const Eigen::Vector2f right = Eigen::Vector2d(-camera.fx, camera.width - 0.5 - camera.cx).normalized().cast<float>();
  const Eigen::Vector2f top = Eigen::Vector2d(camera.fy, camera.cy + 0.5).normalized().cast<float>();
  const Eigen::Vector2f foot = Eigen::Vector2d(-camera.fy, camera.height - 0.5 - camera.cy).normalized().cast<float>();
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const BrickPosition& p = positions_[i];
    const Eigen::Vector3f c =
        R * Eigen::Vector3f(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)) + t;
    if (c.z() < -radius || c.z() > farthest) continue;
    if (left.x() * c.x() + left.y() * c.z() < -radius || right.x() * c.x() + right.y() * c.z() < -radius) continue;
    if (top.x() * c.y() + top.y() * c.z() < -radius || foot.x() * c.y() + foot.y() * c.z() < -radius) continue;
    s.visible.push_back(static_cast<std::int32_t>(i));
    s.centres.push_back(c);
  }
}

}  // namespace saccade
