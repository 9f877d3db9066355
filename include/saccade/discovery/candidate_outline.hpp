#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/distorted_pixels.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"
#include "saccade/discovery/segment_columns.hpp"

namespace saccade {

/// Where a candidate lies in the input's own colour image, free of the frame's segments: what files say of it.
struct CandidateOutline {
  cv::Rect box;      ///< pixels; width = max u - min u + 1
  std::string mask;  ///< compressed COCO run lengths of the whole image
};

/// Outlines candidates in the pixels of the input's colour image. The stages work on images of the ideal camera C; a
/// lens that distorts moves a candidate by up to tens of pixels at the image's edge, and whoever lays boxes and masks
/// over the input's files, or compares them with labels drawn there, needs them there.
///
/// One per thread.
class CandidateOutliner {
 public:
  explicit CandidateOutliner(DistortedPixels pixels) : pixels_(std::move(pixels)) {}

  /// Takes the segments of a frame that the candidates are made of. Cost: a pass over both segmentations, twice
  /// as much where there is distortion.
  void begin(const FrameSegments& seen, std::span<const Candidate> open, std::span<const Candidate> inhibited = {});
  /// Outline of one of the candidates that were begun with: a few microseconds. A candidate that the input's image does
  /// not show (it may end before C's does) has an empty box.
  [[nodiscard]] CandidateOutline outline(const Candidate& candidate) const;

  [[nodiscard]] cv::Size imageSize() const { return pixels_.size(); }

 private:
  void want(std::span<const Candidate> candidates);
  void take(const Segmentation& ideal, std::span<const char> wanted, SegmentColumns& columns);

  DistortedPixels pixels_;
  std::vector<char> wanted_color_, wanted_surface_;  // by segment
  std::vector<std::int32_t> row_;                    // of labels, in the input's pixels
  SegmentColumns color_, surface_;
};

}  // namespace saccade
