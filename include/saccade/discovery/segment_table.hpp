#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/crack_counter.hpp"
#include "saccade/discovery/label_runs.hpp"
#include "saccade/discovery/run_sums.hpp"
#include "saccade/segmentation/segmentation.hpp"

namespace saccade {

/// Raw image moments up to order 3 of a set of pixels, about the pixel that SegmentTable::momentOrigin() names.
struct RawMoments {
  std::int64_t m00 = 0, m10 = 0, m01 = 0, m20 = 0, m11 = 0, m02 = 0, m30 = 0, m21 = 0, m12 = 0, m03 = 0;

  RawMoments& operator+=(const RawMoments& other);
};

/// Sums over the pixels of one segment; those of a union of segments are the sums of theirs.
struct SegmentSums {
  int area = 0;
  int min_u = 0, min_v = 0, max_u = -1, max_v = -1;  ///< bounding box, ends included
  RawMoments moments;
  double saliency = 0.0;
  std::array<double, 3> color{};    ///< B, G, R
  double color_squared = 0.0;       ///< of all three channels together
  int depth_count = 0;              ///< pixels with a measured vertex
  std::array<double, 3> vertex{};   ///< metres, frame C
  std::array<double, 6> scatter{};  ///< Σ xx, xy, xz, yy, yz, zz about the origin of C
  int normal_count = 0;             ///< pixels with a normal
  std::array<double, 3> normal{};

  SegmentSums& operator+=(const SegmentSums& other);
  [[nodiscard]] cv::Rect box() const { return {min_u, min_v, max_u - min_u + 1, max_v - min_v + 1}; }
};

/// The cracks (unit edges between a pixel inside and a pixel outside) that a segment shares with one neighbour.
struct SegmentEdge {
  std::int32_t neighbor = 0;  ///< segment id, kUnsegmented or kImageBorder
  int length = 0;             ///< cracks, pixels
  int known = 0;              ///< of them: depth is known on both sides
  int nearer = 0;             ///< of the known: this segment is nearer by more than the depth step
  int farther = 0;            ///< of the known: the neighbour is nearer by more than the depth step
  double color_step = 0.0;    ///< sum over the cracks of the colour difference across, each 0..1
};

/// Everything the candidate stages need to know about the segments of one segmentation, gathered in one pass over the
/// image, so that a candidate made of n segments gets its area, moments, outline and means in O(n).
///
/// Owns the sums, the neighbourhood and a few 3D points of each segment; leaves the label image to its Segmentation.
/// build() recycles all buffers. Not thread-safe while building, afterwards any number of readers.
class SegmentTable {
 public:
  static constexpr std::int32_t kUnsegmented = -1;
  static constexpr std::int32_t kImageBorder = -2;
  static constexpr int kDirections = 32;  ///< directions in which the extreme points of a segment are kept

  /// Farthest points of a segment in the table's directions, by which the hull of any union is found quickly.
  struct Extremes {
    std::array<float, kDirections> reach;    ///< direction · point, metres; -inf where the segment has no point
    std::array<float, kDirections> x, y, z;  ///< the point itself, frame C
  };

  /// Gathers the sums of `segmentation`. `saliency` and `color` have its size; `depth` may be null (colour only).
  /// About 4 ms for 640×480. Throws std::invalid_argument if sizes differ or labels are not below the count.
  void build(const Segmentation& segmentation, const cv::Mat1f& saliency, const cv::Mat3b& color,
             const DepthMaps* depth);
  /// The same for two segmentations of one image, whose pixels are read once.
  static void build(SegmentTable& first, const Segmentation& of_first, SegmentTable& second,
                    const Segmentation& of_second, const cv::Mat1f& saliency, const cv::Mat3b& color,
                    const DepthMaps* depth);

  [[nodiscard]] int count() const { return static_cast<int>(sums_.size()); }
  [[nodiscard]] cv::Size imageSize() const { return size_; }
  [[nodiscard]] bool hasDepth() const { return has_depth_; }
  [[nodiscard]] cv::Point momentOrigin() const { return {size_.width / 2, size_.height / 2}; }

  /// The segmentation's runs, for whatever else goes through its pixels.
  [[nodiscard]] const LabelRuns& runs() const { return runs_; }
  [[nodiscard]] const SegmentSums& sums(std::int32_t segment) const { return sums_[static_cast<std::size_t>(segment)]; }
  /// Neighbours by rising id (kImageBorder and kUnsegmented first).
  [[nodiscard]] std::span<const SegmentEdge> edges(std::int32_t segment) const {
    const auto s = static_cast<std::size_t>(segment);
    return {edges_.data() + edge_begin_[s], edges_.data() + edge_begin_[s + 1]};
  }
  /// A few measured points spread evenly over the segment, frame C. None without depth.
  [[nodiscard]] std::span<const Eigen::Vector3f> samples(std::int32_t segment) const {
    const auto s = static_cast<std::size_t>(segment);
    return {samples_.data() + s * kMaxSamples, static_cast<std::size_t>(sampling_[s].count)};
  }
  /// Only with depth.
  [[nodiscard]] const Extremes& extremes(std::int32_t segment) const {
    return extremes_[static_cast<std::size_t>(segment)];
  }

 private:
  static constexpr std::size_t kMaxSamples = 32;

  /// Which of a segment's points are kept as samples.
  struct Sampling {
    int count = 0, stride = 1, wait = 1;
    std::uint32_t random = 1;
  };

  void begin(const Segmentation& segmentation, bool has_depth);
  void addSample(std::size_t segment, const Eigen::Vector3f& point);
  void preparePixels();
  [[nodiscard]] PixelRow pixelRow(int v, const cv::Mat1f& saliency, const cv::Mat3b& color, const DepthMaps* depth);
  static void addPoints(SegmentTable& first, SegmentTable& second, const cv::Vec3f* vertices);
  void takeSums();
  void takeEdges();

  cv::Size size_;
  bool has_depth_ = false;
  LabelRuns runs_;
  std::vector<SegmentSums> sums_;
  std::vector<std::size_t> edge_begin_;
  std::vector<SegmentEdge> edges_;
  std::vector<Eigen::Vector3f> samples_;
  std::vector<Sampling> sampling_;
  std::vector<Extremes> extremes_;

  std::vector<double> added_;  ///< kRunSums of each segment, first those of the pixels in none
  CrackCounter cracks_;
  // Of the first of the tables that are built together.
  PixelSteps steps_;
  std::vector<CommonRun> common_runs_;
  std::vector<double> column_powers_;
  std::vector<cv::Vec3f> padded_vertices_, padded_normals_;
  std::vector<cv::Vec3b> padded_color_;
};

}  // namespace saccade
