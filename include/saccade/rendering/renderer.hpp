#pragma once

#include <memory>

#include "saccade/core/camera.hpp"
#include "saccade/core/config_fields.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/map_cursor.hpp"
#include "saccade/rendering/ior_view.hpp"

namespace saccade {

/// Working range of the renderer.
struct RendererConfig {
  double near_m =
      0.1;             ///< along the optical axis; rays start here, so that a camera inside an occupied leaf still sees
  double far_m = 8.0;  ///< along the optical axis; what is entered beyond is a hole

  void describe(ConfigVisitor& v) {
    v.number("near", near_m, {1e-3, 100.0}, "m", "depth at which rays start");
    v.number("far", far_m, {1e-3, 1000.0}, "m", "depth at which rays end");
  }
};

/// Renders the octree at any pose of any pinhole camera (paper, "2D IOR map").
///
/// Of each pixel's ray from `near` on it finds the first occupied finest leaf; free and unknown space are both passed.
/// The result is that of a traversal ray by ray, but the work is shared by all rays: the octree is walked once, front
/// to back, with what lies outside the image or behind pixels that are already taken cut off, and each leaf that may be
/// seen is intersected exactly with the few rays that may meet it.
///
/// Owns the buffers, which it recycles: rendering allocates only when the image grows or more leaves are seen than ever
/// before. Leaves to others: what inhibits a candidate (discovery), which leaves to attend (BackProjector).
/// Thread rule: one renderer per thread; many may read one map while nobody writes it. Same input, same bytes.
class Renderer {
 public:
  using Config = RendererConfig;

  /// Throws std::invalid_argument if a field is out of range or near ≥ far.
  explicit Renderer(const Config& config = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Depth, 2D IOR map and leaves at the map's tick. The view belongs to the renderer and is overwritten by its next
  /// call; copy it with cloneView() to keep it. Cost: a few ms for 640×480 pixels and 1 cm leaves.
  /// Throws std::invalid_argument for a camera without pixels or focal length and for a pose that is not finite.
  [[nodiscard]] const IorView& renderIor(const MapTree& map, const PinholeCamera& camera, const Pose& T_WC);

  /// The same with colour, normals and weights, for pictures. Where a leaf remembers no normal it is the face through
  /// which the ray enters, or, where the ray starts inside the leaf, the direction against the ray.
  [[nodiscard]] const SurfaceView& renderSurface(const MapTree& map, const PinholeCamera& camera, const Pose& T_WC);

  [[nodiscard]] const Config& config() const;

 private:
  struct Buffers;
  Config config_;
  std::unique_ptr<Buffers> buffers_;
};

/// A copy with images of its own.
[[nodiscard]] IorView cloneView(const IorView& view);

}  // namespace saccade
