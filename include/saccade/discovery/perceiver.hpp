#pragma once

#include "saccade/attention/saliency.hpp"
#include "saccade/attention/salient_blobs.hpp"
#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/discovery/perception.hpp"
#include "saccade/segmentation/color_segments.hpp"
#include "saccade/segmentation/surface_segments.hpp"

namespace saccade {

struct PerceptionConfig {
  SaliencyConfig saliency;
  BlobConfig blobs;
  ColorSegmentsConfig color = fineColor();
  SurfaceSegmentsConfig surface = fineSurface();
  SupportPlaneConfig planes;
  int max_maxima = 64;

  /// Finer than the paper's segments: small things get segments of their own, and merging finds the large ones. Chosen
  /// on labelled frames for development, see docs/evaluation.md.
  static ColorSegmentsConfig fineColor() {
    ColorSegmentsConfig color;
    color.halved = true;
    color.k = 400.0;
    color.sigma = 0.3;
    return color;
  }
  static SurfaceSegmentsConfig fineSurface() {
    SurfaceSegmentsConfig surface;
    surface.min_size = 60;
    return surface;
  }

  void describe(ConfigVisitor& v) {
    v.section("saliency", saliency, "saliency map");
    v.section("blobs", blobs, "salient blobs");
    v.section("color", color, "colour segments");
    v.section("surface", surface, "surface segments");
    v.section("planes", planes, "supporting planes");
    v.integer(
        "max_maxima", max_maxima, {0, 1000000}, "",
        "blobs are grown from this many of the most salient maxima; 0 = all, as the paper does, at a second a frame");
  }
};

/// Runs the attention branch on a frame: saliency, salient blobs, colour and surface segments, and their tables.
///
/// Owns the stage objects with their scratch memory; the result is the caller's and shares nothing with them, so the
/// next frame may be perceived while the last result is still in use. One object serves one frame at a time, and takes
/// idle threads of TBB to help. Needs nothing but
/// the frame and its depth maps: no pose, no map, no memory of earlier frames.
class Perceiver {
 public:
  /// Throws std::invalid_argument if a setting is out of range.
  explicit Perceiver(PerceptionConfig config = {});

  /// Milliseconds of the last perceive(), by step.
  struct Times {
    double saliency_ms = 0.0, blobs_ms = 0.0, color_ms = 0.0, surface_ms = 0.0, tables_ms = 0.0;
  };

  /// Fills `seen`, whose buffers are reused. `depth` may be null: colour only.
  void perceive(const cv::Mat3b& color, const DepthMaps* depth, Perception& seen);

  /// The same in parts: the first two of a frame may run beside each other, the third follows both. What colour alone
  /// tells need not wait until the depth is known.
  void perceiveColor(const cv::Mat3b& color, Perception& seen);
  void perceiveSurface(const DepthMaps* depth, Perception& seen);
  void relate(const cv::Mat3b& color, const DepthMaps* depth, Perception& seen);

  [[nodiscard]] const Times& times() const { return times_; }

 private:
  void growBlobs(Perception& seen);

  PerceptionConfig config_;
  SaliencyModel saliency_;
  BlobGrower blobs_;
  ColorSegmenter color_;
  SurfaceSegmenter surface_;
  Times times_;
};

}  // namespace saccade
