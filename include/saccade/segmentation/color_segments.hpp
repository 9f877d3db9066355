#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"
#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

class LabelUpsampler;

/// Settings of the colour segmentation; k as in the paper.
struct ColorSegmentsConfig {
  double k = 200.0;    ///< scale of observation: larger k, larger segments; in units of colour distance times pixels
  double sigma = 0.5;  ///< px (of the half if `halved`), Gaussian smoothing before segmentation; 0 = none
  int min_size = 50;   ///< px; smaller segments join the neighbour across their weakest edge
  /// Merges the means of 2 x 2 pixels instead, with `k` and `min_size` as many pixels of the whole image, and fits the
  /// outlines to the image afterwards: for a third of the time, segments that are not the textbook's, but as good.
  bool halved = false;

  void describe(ConfigVisitor& visitor);
};

/// Segments colour images by graph-based region merging (Felzenszwalb & Huttenlocher 2004; paper, "Image
/// segmentation").
///
/// Pixels are joined to their 8 neighbours by edges weighted with the Euclidean distance of smoothed colours (0..255);
/// edges are taken by rising weight, and two components merge if the edge is no heavier than Int(C) + k / |C| of both.
/// Weights are sorted in steps of 0.1 %; edges within a step are taken in row order. Segments are connected, unless
/// `halved`: fitted outlines may part a few pixels from theirs, or leave less than `min_size`. Owns all scratch memory;
/// one object serves one thread, images of a new size reallocate.
class ColorSegmenter {
 public:
  /// Throws std::invalid_argument if a setting is out of range.
  explicit ColorSegmenter(ColorSegmentsConfig config = {});
  ~ColorSegmenter();
  ColorSegmenter(ColorSegmenter&&) noexcept;
  ColorSegmenter& operator=(ColorSegmenter&&) noexcept;

  /// Segments of a BGR image; every pixel belongs to one. The result is overwritten by the next call. Throws
  /// std::invalid_argument on an empty image.
  const Segmentation& segment(const cv::Mat3b& bgr);
  /// The same, written to `segmentation`, whose buffer is reused.
  void segment(const cv::Mat3b& bgr, Segmentation& segmentation);

  [[nodiscard]] const ColorSegmentsConfig& config() const { return config_; }

 private:
  class Graph;

  ColorSegmentsConfig config_;
  std::unique_ptr<Graph> graph_;
  std::unique_ptr<LabelUpsampler> upsampler_;
  Segmentation segmentation_, half_;
};

}  // namespace saccade
