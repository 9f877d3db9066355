#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "map/endpoint_leaves.hpp"
#include "map/sibling_bounds.hpp"
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
  /// Which of eight siblings lie behind everything measured where they are seen, and which before all of it, as bits.
  struct Sights {
    unsigned hidden = 0, free = 0;
  };

  void build(const EndpointLeaves& endpoints, const WorkingDepth& depth, const PinholeCamera& camera,
             const Eigen::Matrix3f& R_CW, const FrameCube& cube);

  /// Pixels around the image that are still covered.
  [[nodiscard]] int margin() const { return 2 * margin_; }

  /// Cells in a row and in a column, margin included.
  [[nodiscard]] int widthCells() const { return width_; }
  [[nodiscard]] int heightCells() const { return height_; }

  /// The sights of the siblings `asked` for, which must be bounded and not empty.
  [[nodiscard]] Sights sights(const SiblingBounds& siblings, unsigned asked) const {
    return sights(levels_.data(), farthest_ends_.data(), siblings, asked);
  }

  /// Which of `wanted` of the eight finest leaves of a family some ray crosses before its end, as bits by child number.
  /// `low` is the family's lowest corner from the camera, in leaves; sibling i of `bounds` is its projection. Rays of
  /// cells beside it may be tested too: a ray that crosses, crosses.
  [[nodiscard]] unsigned crossedLeaves(const SiblingBounds& bounds, unsigned i, const float* low,
                                       unsigned wanted) const;
  /// The same over all rays, for a family too close to the camera to have bounds.
  [[nodiscard]] unsigned crossedLeaves(const float* low, unsigned wanted) const;

 private:
  struct Range {
    float minus_lowest;  // smallest depth of a pixel, negative; 0 if one has no measurement or lies outside the image
    float highest;       // largest depth of a ray's end; 0 if there is no ray
  };
  struct Level {
    int width = 0, height = 0;  // `blocks` are readable for kLanes beyond
    std::vector<Range> blocks;
  };
  static Sights sights(const Level* levels, const float* farthest_ends, const SiblingBounds& siblings, unsigned asked);
  [[nodiscard]] std::size_t placeOf(std::int32_t x, std::int32_t y) const {
    const auto width = static_cast<std::size_t>(width_);
    return static_cast<std::size_t>(y / 2) * 2 * width + 2 * static_cast<std::size_t>(x) +
           static_cast<std::size_t>(y & 1);
  }
  void projectRays(const EndpointLeaves& endpoints, const PinholeCamera& camera, EndProjection& projection);
  void groupRays();
  void boundPixels(const WorkingDepth& depth);
  void buildLevels();

  int width_ = 0, height_ = 0, margin_ = 0;  // cells
  // First ray of each cell, and the end. Cells are numbered by columns inside of rows of two, so that the rays of a box
  // are few runs.
  std::vector<std::uint32_t> starts_;
  // Of each ray the inverse of the vector from the camera to its end, so that a point of it at the share t of its
  // length has t = (p - camera) * inverse along each axis. By cells, and then padding that crosses nothing.
  std::vector<float> inverse_x_, inverse_y_, inverse_z_;
  std::size_t ray_count_ = 0;
  struct Projected {  // the same by leaves, with depth, cell and place in starts_
    std::vector<float> depth, inverse_x, inverse_y, inverse_z;
    std::vector<std::int32_t> cell, place;
  } projected_;
  std::vector<Level> levels_;
  // `highest` of the finest level by itself, so that one load reads a row of a small node; readable for kLanes beyond.
  std::vector<float> farthest_ends_;
};

}  // namespace saccade
