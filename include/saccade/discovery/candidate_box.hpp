#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

/// An axis-parallel box in W, metres.
using WorldBox = Eigen::AlignedBox3f;

/// The box around the measured points of a candidate's mask; none if there are none. Cost: the mask's pixels.
[[nodiscard]] std::optional<WorldBox> candidateBox(const Candidate& candidate, const FrameSegments& seen,
                                                   const DepthMaps& depth, const Pose& T_WC);

/// The same boxes for many candidates of a frame: one pass over the image bounds each segment, and a candidate's box is
/// that around those of its segments.
class CandidateBoxes {
 public:
  /// Bounds the segments. The vertices have the size of the labels.
  void begin(const FrameSegments& seen, const cv::Mat3f& vertices, const Pose& T_WC);
  /// Nothing is measured: no candidate has a box.
  void beginWithoutDepth() { has_depth_ = false; }
  [[nodiscard]] std::optional<WorldBox> box(const Candidate& candidate) const;

 private:
  bool has_depth_ = false;
  std::vector<WorldBox> color_, surface_;  ///< by segment
};

}  // namespace saccade
