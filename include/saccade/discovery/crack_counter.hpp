#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/label_runs.hpp"

namespace saccade {

/// How the depths on both sides of a crack compare.
enum DepthStep : std::uint8_t { kUnknownDepth, kNoStep, kFirstNearer, kSecondNearer, kDepthSteps };

/// What lies between neighbouring pixels of an image, whichever segments they are in; row by row from the top.
class PixelSteps {
 public:
  /// Between pairs of pixels, the one to the left or above first.
  struct Row {
    std::vector<std::uint16_t> color;  ///< sum of the channels' absolute differences
    std::vector<std::uint8_t> depth;   ///< DepthStep
  };

  /// `depth` may be null: then all depths are unknown. Both must outlive the rows.
  void begin(const cv::Mat3b& color, const DepthMaps* depth);
  /// Moves on to the next row, the first time to row 0.
  void nextRow();

  [[nodiscard]] const Row& beside() const { return beside_; }  ///< at u: between the pixels u and u + 1
  [[nodiscard]] const Row& above() const { return above_; }    ///< none at row 0

 private:
  struct Pixels {
    std::array<std::vector<std::uint8_t>, 3> color;
    std::vector<float> z_m;
  };

  void compare(const Pixels& first, const Pixels& second, int offset, int count, Row& steps) const;

  const cv::Mat3b* color_ = nullptr;
  const DepthMaps* depth_ = nullptr;
  int row_ = -1;
  Pixels pixels_, pixels_above_;
  Row beside_, above_;
};

/// Counts the cracks between the segments of one segmentation, pair by pair. Buffers are recycled.
class CrackCounter {
 public:
  /// Cracks between two segments, or a segment and what is in none (-1).
  struct Pair {
    std::int32_t first = 0, second = 0;  ///< first < second
    std::array<std::int32_t, kDepthSteps> cracks{};
    std::int64_t color = 0;  ///< sum of the channels' differences
  };

  void begin(int segments);
  /// Counts the cracks within row `v` and to the row above.
  void addRow(const LabelRuns& runs, int v, const PixelSteps& steps);

  /// In no order that means anything.
  [[nodiscard]] const std::vector<Pair>& pairs() const { return pairs_; }
  /// Cracks of a segment along the image's border.
  [[nodiscard]] int border(std::int32_t segment) const { return border_[static_cast<std::size_t>(segment) + 1]; }

 private:
  /// The pair that a segment was last met in. Boundaries go on from row to row: mostly it is met again.
  struct Recent {
    std::int32_t other, pair;
  };

  std::size_t pairOf(std::int32_t a, std::int32_t b, std::vector<Recent>& recent);
  std::size_t findPair(std::int32_t a, std::int32_t b);
  [[nodiscard]] std::size_t placeOf(std::int32_t first, std::int32_t second) const;
  void growPlaces();
  void count(std::int32_t a, std::int32_t b, const PixelSteps::Row& steps, int begin, int end,
             std::vector<Recent>& recent);

  std::vector<Pair> pairs_;
  std::vector<std::int32_t> places_;  ///< open hash table of indices into pairs_; kEmpty where there is none
  std::vector<Recent> recent_beside_, recent_below_;  ///< by label + 1
  std::vector<int> border_;                           ///< by label + 1
};

}  // namespace saccade
