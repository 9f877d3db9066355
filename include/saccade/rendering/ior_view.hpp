#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/ior_law.hpp"
#include "saccade/map/leaf_key.hpp"
#include "saccade/map/leaf_surface.hpp"

namespace saccade {

/// A finest leaf that some pixel sees, with what it held when it was rendered.
///
/// Of a coarse (pruned) leaf each cell that is seen stands here by itself, under its own finest key.
struct VisibleLeaf {
  LeafKey key;
  IorState ior;
  LeafSurface surface;
};

/// The 2D IOR map with depth, and the leaf behind each pixel, of one pose (paper, "2D IOR map").
///
/// A value of its own: it stays good when the map changes. All images have the camera's size; a pixel whose ray meets
/// nothing occupied in the renderer's range is a hole: depth 0, not inhibited, not familiar, no leaf.
struct IorView {
  static constexpr std::int32_t kNoLeaf = -1;

  PinholeCamera camera;
  Pose T_WC = Pose::Identity();
  Tick now;                         ///< the map's tick when it was rendered
  double leaf_size_m = 0.0;         ///< edge of a finest leaf
  cv::Mat1f depth_m;                ///< where the ray enters the leaf, along the optical axis; 0 = hole
  cv::Mat1b inhibited;              ///< 255 where the leaf inhibits at `now`, else 0: the paper's I(x, y)
  cv::Mat1b familiar;               ///< 255 where the leaf was attended and is forgotten at `now`, else 0
  cv::Mat1i leaf_index;             ///< position in `leaves`, or kNoLeaf
  std::vector<VisibleLeaf> leaves;  ///< each seen leaf once, front to back by the octree's order

  /// The leaf that pixel (u, v) sees, which must lie in the image; null at a hole.
  [[nodiscard]] const VisibleLeaf* leafAt(int u, int v) const {
    const std::int32_t index = leaf_index(v, u);
    return index == kNoLeaf ? nullptr : &leaves[static_cast<std::size_t>(index)];
  }
  /// Key of the leaf that pixel (u, v) sees; empty at a hole.
  [[nodiscard]] std::optional<LeafKey> keyAt(int u, int v) const {
    const VisibleLeaf* leaf = leafAt(u, v);
    return leaf == nullptr ? std::nullopt : std::optional(leaf->key);
  }
  /// IOR weight at pixel (u, v) and tick `now`; 0 at a hole.
  [[nodiscard]] std::uint32_t weightAt(int u, int v) const {
    const VisibleLeaf* leaf = leafAt(u, v);
    return leaf == nullptr ? 0 : weight(leaf->ior, now);
  }
};

/// An IorView with the pictures that only people look at.
struct SurfaceView {
  IorView ior;
  cv::Mat3b color;    ///< BGR, what the leaf remembers; black at holes
  cv::Mat3f normals;  ///< unit length, frame W; (0, 0, 0) at holes
  cv::Mat1i weight;   ///< IOR weight at `ior.now`; 0 at holes
};

}  // namespace saccade
