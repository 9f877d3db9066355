#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "saccade/attention/salient_blobs.hpp"
#include "saccade/core/camera.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/segment_overlap.hpp"
#include "saccade/discovery/segment_table.hpp"
#include "saccade/discovery/support_planes.hpp"
#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

/// The two segmentations of one frame, whose segments make up its candidates.
struct FrameSegments {
  Segmentation color;
  Segmentation surface;  ///< no segments without depth

  [[nodiscard]] const Segmentation& segmentation(CandidateSource source) const {
    return source == CandidateSource::kColor ? color : surface;
  }
};

/// What the eye made of one frame before it knows of objects: saliency, blobs and both segmentations, and their sums.
///
/// Owns everything the candidate stages read, so that it can be handed from the attention branch to the frame's end.
/// The images may share memory with the stages that made them (cv::Mat headers): valid until those see the next frame.
struct Perception : FrameSegments {
  PinholeCamera camera;
  bool has_depth = false;
  cv::Mat1f saliency;  ///< 0..1
  std::vector<SalientBlob> blobs;
  SegmentTable color_segments;
  SegmentTable surface_segments;
  SegmentOverlap overlap;  ///< first: colour, second: surface
  SupportPlanes planes;

  /// Fills the tables, the overlap and the planes from saliency, color and surface. `depth` null: colour only, and
  /// `surface` is emptied.
  void makeTables(const cv::Mat3b& image, const DepthMaps* depth, const SupportPlaneConfig& config = {});

  [[nodiscard]] const SegmentTable& table(CandidateSource source) const {
    return source == CandidateSource::kColor ? color_segments : surface_segments;
  }
  [[nodiscard]] cv::Size imageSize() const { return saliency.size(); }
};

}  // namespace saccade
