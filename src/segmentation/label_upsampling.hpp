#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

/// Halves images and brings labels of the half back to the whole, along the whole's own outlines.
///
/// A pixel of the half is the mean of 2 x 2 of the whole's; at odd ends the last ones are taken twice. A pixel of the
/// whole takes the label of the one it is part of, or of one of the three that it lies next to there: of which its
/// colour differs least, by the sum over the channels. Owns the half and row buffers; images of a new size reallocate.
class LabelUpsampler {
 public:
  /// The half of an image that is not empty; overwritten by the next call.
  const cv::Mat3b& halve(const cv::Mat3b& image);

  /// Overwrites `result`, numbered by first pixel in row order. `image` is the one halved last; `half` labels every
  /// pixel of its half.
  void upsample(const Segmentation& half, const cv::Mat3b& image, Segmentation& result);

 private:
  /// A row of the half at the whole's columns: the pixel that each column is part of, and the one beside it.
  struct WideRow {
    int row = -1;  ///< of the half
    std::array<std::vector<std::uint8_t>, 3> own_color, beside_color;
    std::vector<std::int32_t> own_label, beside_label;
  };

  void resize(int width);
  const WideRow& widened(const cv::Mat1i& half_labels, int row);

  cv::Mat3b half_;
  std::array<WideRow, 3> rows_;  ///< a ring of the last ones
  std::array<std::vector<std::uint8_t>, 3> split_;
  std::vector<std::int32_t> chosen_;
  std::vector<int> numbers_;  ///< in the result, by label of the half
};

}  // namespace saccade
