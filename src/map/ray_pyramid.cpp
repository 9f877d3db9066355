#include "map/ray_pyramid.hpp"

#include <cmath>

namespace saccade {
namespace {

/// Cells beyond which the margin does not grow, however near the surface.
constexpr int kLargestMargin = 32;

float inverseOf(float component) {
  constexpr float kSmallest = 1e-6f;  // keeps rays along a plane of leaf walls free of 0 * infinity
  return 1.0f / (std::fabs(component) < kSmallest ? std::copysign(kSmallest, component) : component);
}

}  // namespace

void RayPyramid::build(const EndpointLeaves& endpoints, const WorkingDepth& depth, const PinholeCamera& camera,
                       const Eigen::Matrix3f& R_CW, const FrameCube& cube) {
  float nearest = 3.0e38f;
  for (const auto& hit : endpoints.hits()) {
    const EndpointLeaves::Seen& seen = endpoints.seen(hit);
    const Eigen::Vector3f d = seen.centre() - cube.camera_leaves;
    nearest = std::min(nearest, R_CW.row(2).dot(d));
  }
  // Half a leaf's diagonal, as it looks at the nearest point.
  const double pixels = 0.87 * std::max(camera.fx, camera.fy) / std::max(1.0, static_cast<double>(nearest));
  margin_ = std::min(kLargestMargin, static_cast<int>(pixels / 2.0) + 1);
  width_ = (camera.width + 1) / 2 + 2 * margin_;
  height_ = (camera.height + 1) / 2 + 2 * margin_;
  if (levels_.empty()) levels_.emplace_back();
  levels_[0].width = width_;
  levels_[0].height = height_;
  levels_[0].blocks.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), Range{0.0f, 0.0f});
  boundPixels(depth);
  projectRays(endpoints, camera, R_CW, cube);
  buildLevels();
}

void RayPyramid::boundPixels(const WorkingDepth& depth) {
  for (int y = 0; 2 * y < depth.height(); ++y) {
    const float* a = depth.row(2 * y);
    const float* b = depth.row(std::min(2 * y + 1, depth.height() - 1));
    Range* out = &levels_[0].blocks[static_cast<std::size_t>(y + margin_) * static_cast<std::size_t>(width_) +
                                    static_cast<std::size_t>(margin_)];
    for (int x = 0; 2 * x + 1 < depth.width(); ++x) {
      out[x].lowest = std::min(std::min(a[2 * x], a[2 * x + 1]), std::min(b[2 * x], b[2 * x + 1]));
    }
  }
}

void RayPyramid::projectRays(const EndpointLeaves& endpoints, const PinholeCamera& camera, const Eigen::Matrix3f& R_CW,
                             const FrameCube& cube) {
  projected_.clear();
  const auto fx = static_cast<float>(0.5 * camera.fx), fy = static_cast<float>(0.5 * camera.fy);
  const auto cx = static_cast<float>(0.5 * camera.cx + 0.25 + margin_);
  const auto cy = static_cast<float>(0.5 * camera.cy + 0.25 + margin_);
  starts_.assign(levels_[0].blocks.size() + 1, 0);
  for (const auto& hit : endpoints.hits()) {
    const Eigen::Vector3f d = endpoints.seen(hit).centre() - cube.camera_leaves;
    const Eigen::Vector3f p = R_CW * d;
    const float z = std::max(p.z(), 1e-3f);
    const float x = std::clamp(fx * p.x() / z + cx, 0.0f, static_cast<float>(width_) - 1.0f);
    const float y = std::clamp(fy * p.y() / z + cy, 0.0f, static_cast<float>(height_) - 1.0f);
    const std::uint32_t cell =
        static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width_) + static_cast<std::uint32_t>(x);
    projected_.push_back({cell, z, {inverseOf(d.x()), inverseOf(d.y()), inverseOf(d.z())}});
    ++starts_[cell + 1];
    levels_[0].blocks[cell].highest = std::max(levels_[0].blocks[cell].highest, z);
  }
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  rays_.resize(projected_.size());
  for (const Projected& p : projected_) rays_[starts_[p.cell]++] = p.ray;  // moves every start to its end
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
    level.blocks.resize(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
    for (int y = 0; y < level.height; ++y) {
      const Range* a = &finer.blocks[static_cast<std::size_t>(2 * y) * static_cast<std::size_t>(w)];
      const Range* b = 2 * y + 1 < h ? a + w : a;
      Range* out = &level.blocks[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width)];
      for (int x = 0; x < level.width; ++x) {
        const int l = 2 * x, r = std::min(2 * x + 1, w - 1);
        out[x] = {std::min(std::min(a[l].lowest, a[r].lowest), std::min(b[l].lowest, b[r].lowest)),
                  std::max(std::max(a[l].highest, a[r].highest), std::max(b[l].highest, b[r].highest))};
      }
    }
    w = level.width;
    h = level.height;
  }
}

}  // namespace saccade
