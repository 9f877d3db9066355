#pragma once

#include <array>
#include <cstdint>

namespace saccade {

/// What projecting nodes to the cells of a RayPyramid needs of the camera, lengths in leaves.
struct ProjectionConstants {
  float fx = 0, fy = 0, cx = 0, cy = 0;     ///< in pixels
  std::array<float, 9> R_CW{};              ///< by rows
  std::array<float, 12> planes{};           ///< inward normals of the four sides of the viewing pyramid, camera frame
  float margin_cells = 0;                   ///< cells around the image, on each side
  float width_cells = 0, height_cells = 0;  ///< with the margin
};

/// What bounding siblings of one size needs of the camera: see boundSiblings().
struct SiblingFrame {
  alignas(32) std::array<float, 8> dx, dy, dz;  ///< centre of each sibling from the parent's centre, camera axes
  float half = 0.0f;                            ///< half the sibling's edge
  float z_reach = 0.0f;                         ///< half the depth a sibling spans
  std::array<float, 4> plane_reach{};           ///< half the span along the normal of each side of the pyramid
};

/// Bounds of eight sibling nodes in the image, one lane each: their depths, in leaves, and the cells of a RayPyramid
/// that they touch. Bit i of a set of bits stands for sibling i.
struct SiblingBounds {
  alignas(32) std::array<float, 8> near, far;              ///< depths of the cube
  alignas(32) std::array<std::int32_t, 8> x0, y0, x1, y1;  ///< both ends included; only where bounded
  unsigned outside = 0;                                    ///< wholly outside the viewing pyramid
  unsigned bounded = 0;                                    ///< far enough before the camera to have bounds in the image
  unsigned empty = 0;                                      ///< bounded, but no cell
  unsigned clipped = 0;                                    ///< part of what the node covers lies outside the margin
};

/// Bounds the children of the node whose centre is (px, py, pz) in the camera frame.
void boundSiblings(const ProjectionConstants& c, const SiblingFrame& s, float px, float py, float pz,
                   SiblingBounds& out);

}  // namespace saccade
