#include "saccade/rendering/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/fill_image.hpp"
#include "rendering/octree_walk.hpp"
#include "rendering/pixel_canvas.hpp"
#include "rendering/ray_grid.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {

struct Renderer::Buffers {
  SurfaceView view;
  RayGrid rays;
  PixelCanvas canvas;
  std::vector<std::uint8_t> leaf_inhibited,
      leaf_familiar;  ///< by leaf index + 1, so that kNoLeaf has a place: 0 or 255
  InstructionSet instructions = bestInstructionSet();

  void render(const MapTree& map, const PinholeCamera& camera, const Pose& T_WC, const Config& config);
  void finishImages();
  void shade();
  [[nodiscard]] cv::Vec3f faceNormal(const LeafKey& key, int u, int v) const;
};

namespace {

void requireCamera(const PinholeCamera& camera, const Pose& T_WC) {
  if (camera.width < 1 || camera.height < 1 || !(camera.fx > 0.0) || !(camera.fy > 0.0) ||
      !std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy)) {
    throw std::invalid_argument("Renderer: the camera has " + std::to_string(camera.width) + "x" +
                                std::to_string(camera.height) + " pixels and focal lengths " +
                                std::to_string(camera.fx) + ", " + std::to_string(camera.fy));
  }
  if (!T_WC.matrix().allFinite()) throw std::invalid_argument("Renderer: the pose T_WC is not finite");
}

/// Inverse depth in 1 / leaves to depth in metres, in place; 0 stays 0.
SACCADE_MULTIVERSION void invertDepths(float* depths, int count, float leaf_size_m) {
  for (int i = 0; i < count; ++i) depths[i] = depths[i] > 0.0f ? leaf_size_m / depths[i] : 0.0f;
}

cv::Vec3f toVec(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

/// Fills the IorView for one pose: rays, walk, images.
void Renderer::Buffers::render(const MapTree& map, const PinholeCamera& camera, const Pose& T_WC,
                               const Config& config) {
  requireCamera(camera, T_WC);
  IorView& ior = view.ior;
  ior.camera = camera;
  ior.T_WC = T_WC;
  ior.now = map.now;
  ior.leaf_size_m = map.leaf_size_m;
  ior.leaves.clear();
  ior.depth_m.create(camera.height, camera.width);
  ior.inhibited.create(camera.height, camera.width);
  ior.familiar.create(camera.height, camera.width);
  ior.leaf_index.create(camera.height, camera.width);
  canvas.reset(ior.depth_m, ior.leaf_index);
  if (map.root && rays.prepare(camera, T_WC, map.leaf_size_m, config.near_m, config.far_m) &&
      map.root.logOdds() >= map.occupied_log_odds) {
    walkOctree(map, rays, instructions, canvas, ior.leaves);
  }
  finishImages();
}

/// From inverse depth and leaf to depth, inhibition and familiarity.
void Renderer::Buffers::finishImages() {
  IorView& ior = view.ior;
  leaf_inhibited.assign(ior.leaves.size() + 1, 0);
  leaf_familiar.assign(ior.leaves.size() + 1, 0);
  bool any_attended = false;
  for (std::size_t i = 0; i < ior.leaves.size(); ++i) {
    const IorState state = ior.leaves[i].ior;
    leaf_inhibited[i + 1] = inhibited(state, ior.now) ? 255 : 0;
    leaf_familiar[i + 1] = isFamiliar(state, ior.now) ? 255 : 0;
    any_attended |= wasAttended(state);
  }
  const auto leaf_size_m = static_cast<float>(ior.leaf_size_m);
  for (int v = 0; v < ior.camera.height; ++v) {
    invertDepths(ior.depth_m[v], ior.camera.width, leaf_size_m);
    if (!any_attended) continue;
    const std::int32_t* leaf_index = ior.leaf_index[v];
    std::uint8_t *inhibited_row = ior.inhibited[v], *familiar_row = ior.familiar[v];
    for (int u = 0; u < ior.camera.width; ++u) {
      const auto leaf = static_cast<std::size_t>(leaf_index[u] + 1);
      inhibited_row[u] = leaf_inhibited[leaf];
      familiar_row[u] = leaf_familiar[leaf];
    }
  }
  if (any_attended) return;
  fillImage(ior.inhibited, std::uint8_t{0});
  fillImage(ior.familiar, std::uint8_t{0});
}

/// Fills the pictures beside the IorView.
void Renderer::Buffers::shade() {
  const IorView& ior = view.ior;
  view.color.create(ior.camera.height, ior.camera.width);
  view.normals.create(ior.camera.height, ior.camera.width);
  view.weight.create(ior.camera.height, ior.camera.width);
  for (int v = 0; v < ior.camera.height; ++v) {
    for (int u = 0; u < ior.camera.width; ++u) {
      const VisibleLeaf* leaf = ior.leafAt(u, v);
      if (leaf == nullptr) {
        view.color(v, u) = {0, 0, 0};
        view.normals(v, u) = {0, 0, 0};
        view.weight(v, u) = 0;
        continue;
      }
      const LeafSurface& surface = leaf->surface;
      view.color(v, u) = {surface.blue, surface.green, surface.red};
      const bool has_normal = surface.nx != 0 || surface.ny != 0 || surface.nz != 0;
      view.normals(v, u) = has_normal ? toVec(surface.normal()) : faceNormal(leaf->key, u, v);
      view.weight(v, u) = static_cast<std::int32_t>(weight(leaf->ior, ior.now));
    }
  }
}

/// Outward normal of the face of the leaf's cube through which the pixel's ray enters it.
cv::Vec3f Renderer::Buffers::faceNormal(const LeafKey& key, int u, int v) const {
  const std::array<int, 3> corner = {key.x, key.y, key.z};
  float first = rays.inverse_near;
  cv::Vec3f normal(0, 0, 0), against_ray;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float direction =
        rays.column[axis][static_cast<std::size_t>(u)] + rays.row[axis][static_cast<std::size_t>(v)];
    against_ray[static_cast<int>(axis)] = -direction;
    const float low = inverseDistance(corner[axis], rays.origin[axis]);
    const float high = inverseDistance(corner[axis] + 1, rays.origin[axis]);
    if (low < 0.0f && high > 0.0f) continue;
    const float entry = direction * (high < 0.0f ? high : low);
    if (entry >= first) continue;
    first = entry;
    normal = {0, 0, 0};
    normal[static_cast<int>(axis)] = direction > 0.0f ? -1.0f : 1.0f;
  }
  return normal != cv::Vec3f(0, 0, 0) ? normal : cv::normalize(against_ray);
}

Renderer::Renderer(const Config& config) : config_(config), buffers_(std::make_unique<Buffers>()) {
  requireValid(config_);
  if (config_.near_m >= config_.far_m) {
    throw std::invalid_argument("Renderer: near must be below far, found " + std::to_string(config_.near_m) + " and " +
                                std::to_string(config_.far_m) + " m");
  }
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const Renderer::Config& Renderer::config() const {
  return config_;
}

const IorView& Renderer::renderIor(const MapTree& map, const PinholeCamera& camera, const Pose& T_WC) {
  buffers_->render(map, camera, T_WC, config_);
  return buffers_->view.ior;
}

const SurfaceView& Renderer::renderSurface(const MapTree& map, const PinholeCamera& camera, const Pose& T_WC) {
  buffers_->render(map, camera, T_WC, config_);
  buffers_->shade();
  return buffers_->view;
}

IorView cloneView(const IorView& view) {
  IorView copy = view;
  copy.depth_m = view.depth_m.clone();
  copy.inhibited = view.inhibited.clone();
  copy.familiar = view.familiar.clone();
  copy.leaf_index = view.leaf_index.clone();
  return copy;
}

}  // namespace saccade
