#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"
#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

/// Settings of the colour segmentation; k as in the paper.
struct ColorSegmentsConfig {
  double k = 200.0;    ///< scale of observation: larger k, larger segments; in units of colour distance times pixels
  double sigma = 0.5;  ///< px, Gaussian smoothing before segmentation; 0 = none
  int min_size = 50;   ///< px; smaller segments join the neighbour across their weakest edge

  void describe(ConfigVisitor& visitor);
};

/// Segments colour images by graph-based region merging (Felzenszwalb & Huttenlocher 2004; paper, "Image
/// segmentation").
///
/// Pixels are joined to their 8 neighbours by edges weighted with the Euclidean distance of smoothed colours (0..255);
/// edges are taken by rising weight, and two components merge if the edge is no heavier than Int(C) + k / |C| of both.
/// Weights are sorted in steps of 0.1 %; edges within a step are taken in row order. Owns all scratch memory; one
/// object serves one thread, images of a new size reallocate.
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

  [[nodiscard]] const ColorSegmentsConfig& config() const { return config_; }

 private:
  class Graph;

  ColorSegmentsConfig config_;
  std::unique_ptr<Graph> graph_;
  Segmentation segmentation_;
};

}  // namespace saccade
