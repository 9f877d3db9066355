#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/simulation/scene.hpp"

namespace saccade {

/// Exact images of a scene from one pose.
struct SceneImages {
  cv::Mat3b color;    ///< BGR, lit by the lamps with soft shadows and ambient occlusion
  cv::Mat1f depth_m;  ///< along the optical axis, 0 = nothing there
  cv::Mat1f cosine;   ///< of the angle between the surface normal and the direction to the camera
  cv::Mat1f echo;     ///< share of infrared light that comes back as a usable pattern: low on dark and mirroring places
  cv::Mat1w label;    ///< object id, 0 = background
};

/// Renders a scene with Embree: one ray a pixel finds the triangle, whose plane then gives the depth in double
/// precision. Light does not move, so it is computed once for every vertex (soft lamps, ambient occlusion) when the
/// renderer is made, and costs nothing in a frame.
///
/// Uses all TBB threads; the images depend neither on their number nor on earlier frames. One caller at a time.
class SceneRenderer {
 public:
  /// Takes the scene over and lights it. Throws std::invalid_argument on an empty camera.
  SceneRenderer(Scene scene, const PinholeCamera& camera);
  ~SceneRenderer();
  SceneRenderer(SceneRenderer&&) noexcept;

  [[nodiscard]] const Scene& scene() const;
  /// Renders what the camera at T_WC sees; buffers of `images` are reused.
  void render(const Pose& T_WC, SceneImages& images) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace saccade
