#pragma once

#include <cstdint>
#include <vector>

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
/// Weights are sorted in steps of 0.1 %; edges within a step are taken in row order. Owns all scratch
/// memory; one object serves one thread, images of a new size reallocate.
class ColorSegmenter {
 public:
  /// Throws std::invalid_argument if a setting is out of range.
  explicit ColorSegmenter(ColorSegmentsConfig config = {});

  /// Segments of a BGR image; every pixel belongs to one. The result is overwritten by the next call. Throws
  /// std::invalid_argument on an empty image.
  const Segmentation& segment(const cv::Mat3b& bgr);

  [[nodiscard]] const ColorSegmentsConfig& config() const { return config_; }

 private:
  /// Pixel index * 4 + direction: right, down, down and right, down and left.
  using Edge = std::uint32_t;

  struct WeightedEdge {
    Edge edge;
    std::uint32_t step;  ///< weight in steps
  };
  struct Root {
    float threshold;  ///< Int(C) + k / |C|, grey levels
    int area;         ///< px
  };

  void resize(cv::Size size);
  void weighEdges(const cv::Mat3b& bgr);
  void blurAlongRow(const cv::Mat3b& bgr, int row);
  void blurAcrossRows(int row);
  [[nodiscard]] std::uint32_t stepAtShare(double share) const;
  void gatherLightEdges(std::uint32_t end_step);
  void gatherHeavyEdges(std::uint32_t first_step);
  void takePendingEdges(std::uint32_t end_step);
  void sortBatch();
  void mergeBatch();
  void flattenComponents();
  void absorbSmallSegments();
  void labelSegments();
  [[nodiscard]] int find(int pixel);
  int unite(int root, int other_root);

  ColorSegmentsConfig config_;
  std::vector<float> half_kernel_;
  cv::Size size_;
  std::vector<std::uint8_t> split_;     ///< one row's B, G, R
  std::vector<float> raw_row_;          ///< one channel of a row, with margins
  std::vector<float> row_blurs_;        ///< ring of rows blurred along the row, B, G, R each
  std::vector<float> smooth_;           ///< two smoothed rows, B, G, R each
  std::vector<std::uint16_t> weights_;  ///< in steps; per row four rows, one for each direction
  std::vector<WeightedEdge> batch_;     ///< edges about to be merged, in row order
  std::size_t batch_size_ = 0;
  std::vector<WeightedEdge> pending_;  ///< heavier edges, in row order
  std::size_t pending_size_ = 0;
  std::vector<WeightedEdge> sorted_;  ///< the batch by rising weight
  std::vector<std::uint32_t> step_positions_;
  std::vector<Edge> rejected_;  ///< edges between components that did not merge, by rising weight
  std::vector<int> parent_;
  std::vector<Root> roots_;
  Segmentation segmentation_;
};

}  // namespace saccade
