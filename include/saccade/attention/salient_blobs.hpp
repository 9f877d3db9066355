#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"

namespace saccade {

/// A local maximum of the saliency map: a pixel, or a plateau of equal 8-connected pixels, higher than all around it.
struct SaliencyMaximum {
  cv::Point position;  ///< first pixel of the plateau in row order
  float saliency = 0.0F;
};

/// Pixels of one row: columns first_column ... end_column - 1.
struct PixelRun {
  int row = 0;
  int first_column = 0;
  int end_column = 0;  ///< one past the last
  friend bool operator==(const PixelRun&, const PixelRun&) = default;
};

/// A salient region: 8-connected pixels around a local maximum that reach the share `threshold` of its saliency.
struct SalientBlob {
  cv::Point seed;
  double threshold = 0.0;      ///< the paper's t
  float seed_saliency = 0.0F;  ///< saliency at the seed, the highest in the blob
  std::vector<PixelRun> runs;  ///< sorted by row, then column; runs of a row never touch
  cv::Rect box;                ///< tight
  int area = 0;                ///< pixels
};

struct BlobConfig {
  std::vector<double> thresholds = {0.6, 0.7};  ///< the paper's t, each gives its own blobs
  /// Maxima that are not higher by this than the highest pass to a higher place start no blobs: on real images nine of
  /// ten maxima are ripple on the flank of another one, and grow into nearly the same blobs. 0 = all maxima (the
  /// paper).
  double min_prominence = 0.02;
  int min_area = 15;             ///< px; 30 % of the smallest colour segment, less cannot select one
  double max_area_share = 0.25;  ///< of the image; larger blobs are the background of everything. 1 = all (the paper)

  void describe(ConfigVisitor& visitor);
};

/// All local maxima of a saliency map (paper, "Detection of salient blobs"), by falling saliency, then in row order.
///
/// A plateau counts once; a plateau with nothing lower around it (a constant map) is no maximum, and neither is one of
/// saliency 0. NaN pixels belong to no plateau and bound none. Empty map: no maxima.
[[nodiscard]] std::vector<SaliencyMaximum> findLocalMaxima(const cv::Mat1f& saliency);

/// Grows salient blobs from local maxima by seeded region growing (paper, "Detection of salient blobs").
///
/// A blob of seed l and threshold t is the 8-connected component of { p : sal(l) >= sal(p) >= t * sal(l) } that holds
/// l. Since sal(p) <= sal(l), a seed on the flank of a higher peak does not climb it. Owns scratch bit masks, so keep
/// one object per thread. Cost: proportional to the runs and 64-pixel words that the blobs touch.
class BlobGrower {
 public:
  /// Throws std::invalid_argument if a threshold is not in (0, 1) or the area is negative.
  explicit BlobGrower(BlobConfig config = {});

  /// Blobs of all prominent maxima in their order, for each one per threshold in the order configured. Blobs under
  /// `min_area` or over `max_area_share` are left out; of blobs with equal pixels only the first is kept. The result is
  /// overwritten by the next call. Throws std::invalid_argument if a maximum lies outside the map.
  const std::vector<SalientBlob>& grow(const cv::Mat1f& saliency, const std::vector<SaliencyMaximum>& maxima);

  [[nodiscard]] const BlobConfig& config() const { return config_; }

 private:
  [[nodiscard]] bool isProminent(const cv::Mat1f& saliency, const SaliencyMaximum& maximum);
  void growOne(const cv::Mat1f& saliency, const SaliencyMaximum& maximum, double threshold, SalientBlob& blob);
  bool flood(const cv::Mat1f& saliency, cv::Point seed, std::vector<PixelRun>& runs);
  std::uint64_t& allowedWord(const cv::Mat1f& saliency, int row, int word);
  bool takeRunsTouching(const cv::Mat1f& saliency, int row, int first, int end, std::vector<PixelRun>& runs);
  [[nodiscard]] bool isDuplicate(const SalientBlob& blob, std::size_t count) const;

  BlobConfig config_;
  // The region being flooded: its range of saliency, and what ends the flood early.
  float lowest_ = 0.0F, highest_ = 0.0F;
  float stop_above_ = 0.0F;
  int area_ = 0, most_area_ = 0;
  std::uint32_t stamp_ = 0;
  int words_per_row_ = 0;
  std::vector<std::uint64_t> words_;  ///< 64 columns each: in range and not yet taken; valid where the stamp matches
  std::vector<std::uint32_t> word_stamps_;
  std::vector<PixelRun> ground_;  ///< runs taken by the test of prominence
  std::vector<SalientBlob> blobs_;
};

/// `BlobGrower(config).grow(saliency, maxima)` for single use.
[[nodiscard]] std::vector<SalientBlob> growSalientBlobs(const cv::Mat1f& saliency,
                                                        const std::vector<SaliencyMaximum>& maxima,
                                                        const BlobConfig& config = {});

}  // namespace saccade
