#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// Whether a component accepts to merge along an edge: weight <= Int(C) + k / |C| (Felzenszwalb & Huttenlocher 2004).
[[nodiscard]] inline bool accepts(float internal, int area, float weight, float k) {
  return (weight - internal) * static_cast<float>(area) <= k;
}

/// The edges of a pixel that lead on in row order: to the right, down, down and right, down and left.
inline constexpr int kEdgeDirections = 4;

/// Weights of the edges between the pixels of a colour image and their 8 neighbours: Euclidean distances of smoothed
/// colours (0..255).
///
/// Weights are kept as steps: the highest bits of the squared distance as a float, which rise with the distance by
/// 0.1 % each. Where components are large, k / |C| is a hundredth of a grey level: equal steps of that size would be
/// too many. Edges have one order throughout: by step, then by row, direction and column. Owns the weights and row
/// buffers; images of a new size reallocate.
class ColorEdges {
 public:
  static constexpr int kSteps = 28 << 9;  ///< 3 * 255^2 < 2^18, and all below 2^-10 are step 0
  static constexpr std::uint16_t kStepMask = 0x7FFF;
  static constexpr std::uint16_t kHeaviest = 0x8000;  ///< flag of the last edge, in that order, of any triangle
  static constexpr std::uint16_t kNoEdge = 0xFFFF;    ///< of directions that leave the image

  /// Columns that may be read after the end of a row; they hold no edges.
  static constexpr int kPadding = 64;

  /// `sigma`: px, Gaussian smoothing of the image; 0 = none.
  explicit ColorEdges(double sigma);

  /// Overwrites all weights. The image must not be empty.
  void weigh(const cv::Mat3b& bgr);

  [[nodiscard]] cv::Size size() const { return size_; }

  /// Steps of the edges that begin in a row, one for each column, with flags.
  [[nodiscard]] const std::uint16_t* steps(int row, int direction) const {
    return steps_.data() + static_cast<std::ptrdiff_t>(row * kEdgeDirections + direction) * stride_;
  }

  /// Columns of a row where the edges of a direction begin: first, end. Empty if there are none.
  [[nodiscard]] std::array<int, 2> columns(int row, int direction) const;

  /// For each share the step below which about this part of all edges lies, estimated on every 8th row.
  template <std::size_t N>
  [[nodiscard]] std::array<int, N> stepsAtShares(const std::array<double, N>& rising_shares);

  /// The distance, in grey levels, of the middle of each step.
  [[nodiscard]] static const std::vector<float>& distances();

 private:
  void resize(cv::Size size);
  void smoothAlongRow(const cv::Mat3b& bgr, int row);
  void smoothAcrossRows(int row);
  void markHeaviestBelow(int row);
  std::size_t countSteps();
  [[nodiscard]] std::uint16_t* stepsToWrite(int row, int direction) {
    return steps_.data() + static_cast<std::ptrdiff_t>(row * kEdgeDirections + direction) * stride_;
  }

  std::vector<float> half_kernel_;
  cv::Size size_;
  std::ptrdiff_t stride_ = 0;         ///< of the rows of steps
  std::vector<std::uint8_t> split_;   ///< one row's B, G, R
  std::vector<float> raw_row_;        ///< one channel of a row, with margins
  std::vector<float> row_blurs_;      ///< ring of rows blurred along the row, B, G, R each
  std::vector<float> smooth_;         ///< two smoothed rows, B, G, R each
  std::vector<std::uint16_t> steps_;  ///< per row four rows, one for each direction, padded
  std::vector<std::uint32_t> counts_;
};

template <std::size_t N>
std::array<int, N> ColorEdges::stepsAtShares(const std::array<double, N>& rising_shares) {
  const auto total = static_cast<double>(countSteps());
  std::array<int, N> result;
  result.fill(kSteps);
  double sum = 0.0;
  std::size_t next = 0;
  for (int step = 0; step < kSteps && next < N; ++step) {
    sum += counts_[static_cast<std::size_t>(step)];
    for (; next < N && sum >= rising_shares[next] * total; ++next) {
      result[next] = step + 1;
    }
  }
  return result;
}

}  // namespace saccade
