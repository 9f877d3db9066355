#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <opencv2/core.hpp>

namespace saccade {

/// What is summed over the pixels of segments; those without measurement add zeros.
enum RunSum : std::size_t {
  kSumVertex = 0,       ///< x, y, z in metres, frame C
  kSumDepthCount = 3,   ///< pixels with a measured vertex
  kSumNormal = 4,       ///< x, y, z
  kSumNormalCount = 7,  ///< pixels with a normal
  kSumScatter = 8,      ///< xx, xy, xz, yy, yz, zz
  kSumSaliency = 14,
  kSumColor = 16,         ///< B, G, R
  kSumColorSquared = 19,  ///< of all three channels together
  kSumMoments = 20,       ///< u^i v^j at 4 j + i, about the moments' origin; whole numbers, exact below 2^53
  kRunSums = 36,
};

/// Pixels of a row that belong to one segment of each of two segmentations; they begin where the run before ends.
struct CommonRun {
  std::int32_t end_u = 0;
  std::int32_t first = 0, second = 0;  ///< label + 1: 0 is for pixels in no segment
};

/// A row of pixels. 16 bytes may be read from each vertex and normal, and 4 from each colour.
struct PixelRow {
  const float* saliency;
  const cv::Vec3b* color;
  const cv::Vec3f *vertices, *normals;
  const double*
      column_powers;  ///< before each column u and the end: sums of 1, u, u² and u³, u from the moments' origin
  double v;           ///< from the moments' origin
};

/// Adds the pixels of each run to the kRunSums sums of its segment in both segmentations, where first[0] and second[0]
/// begin those of label -1.
void addRuns(const PixelRow& row, std::span<const CommonRun> runs, double* first, double* second);

}  // namespace saccade
