#pragma once

#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/distorted_pixels.hpp"
#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"

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

  /// Takes the segments of a frame, about 1 ms where there is distortion; `seen` must outlive the outlines' making.
  void begin(const Perception& seen);
  /// Outline of a candidate of the frame that was begun. A candidate that the input's image does not show (it may end
  /// before C's does) has an empty box.
  [[nodiscard]] CandidateOutline outline(const Candidate& candidate) const;

 private:
  /// A segmentation as the input's image shows it.
  struct Distorted {
    Segmentation segmentation;
    std::vector<cv::Rect> boxes;  ///< of each segment
  };

  void distort(const Segmentation& ideal, Distorted& distorted) const;

  DistortedPixels pixels_;
  const Perception* seen_ = nullptr;
  Distorted color_, surface_;
};

}  // namespace saccade
