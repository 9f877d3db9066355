#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "map/endpoint_leaves.hpp"
#include "map/working_depth.hpp"
#include "saccade/core/camera.hpp"

namespace saccade {

/// What projecting the ends of rays to the cells of a RayPyramid needs.
struct EndProjection {
  float camera[3];       ///< from the cube's base, in leaves
  float R_CW[9];         ///< by rows
  float fx, fy, cx, cy;  ///< in cells
  float last_x, last_y;  ///< the last cells
  std::int32_t width;    ///< cells in a row
};

/// The rays of one frame, one to the centre of each leaf that holds a point (as OctoMap's discretised insertion), by
/// the place in the image they go through; and a pyramid of depth bounds over them.
///
/// The image is covered by cells of 2 x 2 pixels, with a margin around it: the centre of a leaf may project a little
/// outside. Depths and lengths are in leaves.
class RayPyramid {
 public:
  struct Range {
    float lowest;   ///< smallest depth of a pixel; 0 if one has no measurement or lies outside the image
    float highest;  ///< largest depth of a ray's end; 0 if there is no ray
  };
  /// Block of cells, both ends included.
  struct Box {
    int x0, y0, x1, y1;
    bool clipped;  ///< part of what was asked for lies outside the margin
    [[nodiscard]] bool empty() const { return x0 > x1 || y0 > y1; }
  };

  void build(const EndpointLeaves& endpoints, const WorkingDepth& depth, const PinholeCamera& camera,
             const Eigen::Matrix3f& R_CW, const FrameCube& cube);

  /// Pixels around the image that are still covered.
  [[nodiscard]] int margin() const { return 2 * margin_; }

  /// Cells that the pixel box [u - du, u + du] x [v - dv, v + dv] touches.
  [[nodiscard]] Box box(float u, float v, float du, float dv) const {
    const auto offset = static_cast<float>(margin_) + 0.25f;  // pixel u covers [u - 0.5, u + 0.5]
    const float x_low = (u - du) * 0.5f + offset, x_high = (u + du) * 0.5f + offset;
    const float y_low = (v - dv) * 0.5f + offset, y_high = (v + dv) * 0.5f + offset;
    const auto w = static_cast<float>(width_), h = static_cast<float>(height_);
    return {static_cast<int>(std::max(x_low, 0.0f)), static_cast<int>(std::max(y_low, 0.0f)),
            static_cast<int>(std::min(x_high + 1.0f, w)) - 1, static_cast<int>(std::min(y_high + 1.0f, h)) - 1,
            x_low < 0.0f || y_low < 0.0f || x_high > w || y_high > h};
  }

  /// Bounds over a box that is not empty; never too tight, a little wide.
  [[nodiscard]] Range range(const Box& b) const {
    unsigned level = 0;
    const int extent = std::max(b.x1 - b.x0, b.y1 - b.y0);
    while (extent >> level > 2) ++level;
    const Level& l = levels_[level];
    Range r{3.0e38f, 0.0f};
    for (int y = b.y0 >> level; y <= b.y1 >> level; ++y) {
      const Range* row = &l.blocks[static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width)];
      for (int x = b.x0 >> level; x <= b.x1 >> level; ++x) {
        r.lowest = std::min(r.lowest, row[x].lowest);
        r.highest = std::max(r.highest, row[x].highest);
      }
    }
    return r;
  }

  /// Which of `wanted` of the eight finest leaves of a family some ray crosses before its end, as bits by child number.
  /// `low` is the family's lowest corner from the camera, in leaves; `box` holds its projection. Rays of cells beside
  /// the box may be tested too: a ray that crosses, crosses.
  [[nodiscard]] unsigned crossedLeaves(const Box& box, const float* low, unsigned wanted) const;
  /// The same over all rays, for a family too close to the camera to have a box.
  [[nodiscard]] unsigned crossedLeaves(const float* low, unsigned wanted) const;

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<Range> blocks;
  };
  void projectRays(const EndpointLeaves& endpoints, const PinholeCamera& camera, EndProjection& projection);
  void groupRays();
  void boundPixels(const WorkingDepth& depth);
  void buildLevels();

  int width_ = 0, height_ = 0, margin_ = 0;  // cells
  std::vector<std::uint32_t> starts_;        // first ray of each cell, and the end
  // Of each ray the inverse of the vector from the camera to its end, so that a point of it at the share t of its
  // length has t = (p - camera) * inverse along each axis. By cells, and then padding that crosses nothing.
  std::vector<float> inverse_x_, inverse_y_, inverse_z_;
  std::size_t ray_count_ = 0;
  struct Projected {  // the same by leaves, with depth and cell
    std::vector<float> depth, inverse_x, inverse_y, inverse_z;
    std::vector<std::int32_t> cell;
  } projected_;
  std::vector<Level> levels_;
};

}  // namespace saccade
