#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

/// Settings of the surface segmentation.
struct SurfaceSegmentsConfig {
  double max_normal_angle_deg = 20.0;   ///< between a point's normal and its patch's
  double max_plane_distance_m = 0.010;  ///< of a point from its patch's plane, at 1 m depth; grows with depth squared
  double max_depth_step_m =
      0.012;           ///< beyond the slope, where a surface still goes on; at 1 m, grows with depth squared
  int min_size = 150;  ///< px; smaller patches are noise

  void describe(ConfigVisitor& visitor);
};

/// Clusters depth images into smooth surface patches (paper, "Surface clustering", after Richtsfeld et al. 2012).
///
/// Patches start at the point of lowest curvature and greedily take neighbouring points that fit the patch's plane,
/// which is refitted as it grows, until all points belong to a patch or are noise; points whose own normal is blurred
/// across a crease go to the adjacent patch whose plane they fit best. Works in inverse depth, where the camera's noise
/// is the same at all ranges, at half the image's size, and assigns the full-size pixels at the end. Normals and
/// curvature are smoothed here: those of the depth maps are made for tracking. Owns all scratch memory; one object
/// serves one thread, images of a new size reallocate.
class SurfaceSegmenter {
 public:
  /// Throws std::invalid_argument if a setting is out of range.
  explicit SurfaceSegmenter(SurfaceSegmentsConfig config = {});
  ~SurfaceSegmenter();
  SurfaceSegmenter(SurfaceSegmenter&&) noexcept;
  SurfaceSegmenter& operator=(SurfaceSegmenter&&) noexcept;

  /// Surface patches; -1 where there is no depth or only noise. The result is overwritten by the next call. Reads
  /// `depth_m` and `camera` of the maps. Throws std::invalid_argument if they are empty or disagree in size.
  const Segmentation& segment(const DepthMaps& depth);
  /// The same, written to `segmentation`, whose buffer is reused.
  void segment(const DepthMaps& depth, Segmentation& segmentation);

  [[nodiscard]] const SurfaceSegmentsConfig& config() const { return config_; }

 private:
  struct Scratch;

  SurfaceSegmentsConfig config_;
  std::unique_ptr<Scratch> scratch_;
  Segmentation segmentation_;
};

}  // namespace saccade
