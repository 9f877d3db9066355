#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"

namespace saccade {

/// Between which depths the rays of a camera can meet the surface of a volume: bounds of everything behind a surface,
/// drawn block by block into a small image. A ray that starts there has the empty space before it behind itself.
///
/// A block is 2 x 2 x 2 samples of a brick; block (x, y, z) is bit x + 4 y + 16 z.
class RayBounds {
 public:
  static constexpr int kCellPixels = 2;  ///< the bounds hold for squares of this many pixels

  /// Forgets all blocks; R_CW turns world directions into the camera's, `sample_m` is the distance of samples.
  void reset(const PinholeCamera& camera, const Eigen::Matrix3f& R_CW, float sample_m, float max_range_m);

  /// Says which pixels' bounds will be asked for, those that are not 0: bricks that bound no such pixel's cell may be
  /// left out. Until the next reset(); `wanted` has the camera's size.
  void limitTo(const cv::Mat1b& wanted);

  /// Adds blocks of the brick whose centre lies at `centre_C`. A surface can lie up to one sample outside of a block
  /// whose samples are behind it.
  void add(const Eigen::Vector3f& centre_C, std::uint64_t blocks);

  /// Per cell of row `v` of the image, the smallest depth of a surface (metres); large where none can be met.
  [[nodiscard]] const float* nearest(int v) const { return nearest_.data() + rowOf(v); }
  /// Per cell, in which slices of depth, each sliceDepth() metres, a surface can be met: slice i is bit i.
  [[nodiscard]] const std::int32_t* slices(int v) const { return slices_.data() + rowOf(v); }
  [[nodiscard]] float sliceDepth() const { return 1.0F / constants_.per_slice; }

 private:
  [[nodiscard]] std::size_t rowOf(int v) const {
    return static_cast<std::size_t>(v / kCellPixels) * static_cast<std::size_t>(stride_);
  }

  [[nodiscard]] bool isWanted(const Eigen::Vector3f& centre_C) const;

  struct Constants {
    float fx, fy, cx, cy;
    float last_u, last_v;
    float sample;     // distance of samples, metres
    float half;       // half edge of what a block bounds, metres
    float half_deep;  // half of the depth that it spans
    float lead;       // by how much rays start before it, to see the side before the surface
    float per_slice;  // slices in a metre
    std::array<float, 9> R_CW;
    alignas(32) std::array<std::array<float, 64>, 3> offset;  // from the brick's centre to its blocks', frame C
  };
  static void draw(const Constants& c, const float* centre, std::uint64_t blocks, int stride, int rows, float* nearest,
                   std::int32_t* slices);

  Constants constants_{};
  int stride_ = 0, rows_ = 0;  // cells
  std::vector<float> nearest_;
  std::vector<std::int32_t> slices_;
  bool is_limited_ = false;
  std::vector<std::int32_t> wanted_before_;  // wanted cells above and left of each corner, rows of `stride_`
};

}  // namespace saccade
