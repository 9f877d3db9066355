#pragma once

#include <cstddef>

#include <opencv2/core.hpp>

#include "saccade/core/depth_maps.hpp"

namespace saccade {

/// What is summed over the pixels of a row; pixels without measurement add zeros.
enum RowSum : std::size_t {
  kRowVertex = 0,       ///< x, y, z in metres, frame C
  kRowDepthCount = 3,   ///< pixels with a measured vertex
  kRowNormal = 4,       ///< x, y, z
  kRowNormalCount = 7,  ///< pixels with a normal
  kRowScatter = 8,      ///< xx, xy, xz, yy, yz, zz
  kRowSaliency = 14,
  kRowColor = 16,         ///< B, G, R
  kRowColorSquared = 19,  ///< of all three channels together
  kRowSums = 20,
};

/// Writes the sums over the pixels of row v left of each column: width + 1 times kRowSums numbers. The sums of any run
/// are the difference of two entries, so that all segmentations of an image share one reading of its pixels. `depth`
/// may be null: then only colour and saliency mean something.
void sumRow(int v, const cv::Mat1f& saliency, const cv::Mat3b& color, const DepthMaps* depth, double* sums);

}  // namespace saccade
