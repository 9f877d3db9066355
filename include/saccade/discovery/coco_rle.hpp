#pragma once

#include <functional>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>

namespace saccade {

/// Returns the `counts` string of the COCO mask format for the pixels of `mask` that are not 0: run lengths in
/// column-major order, the first of a run of zeros, differences to the last but one run from the fourth on, five bits
/// a character. pycocotools' mask.encode gives the same string.
[[nodiscard]] std::string encodeCocoRle(const cv::Mat1b& mask);

/// The same for an image of `size` that is 0 outside of `part`, whose first pixel lies at `corner`. Costs the part's
/// pixels only. Throws std::invalid_argument if the part does not lie within the image.
[[nodiscard]] std::string encodeCocoRle(const cv::Mat1b& part, cv::Point corner, cv::Size size);

/// Calls `visit(u, begin_v, end_v)` for each run of set pixels within a column, columns from the left, runs from the
/// top. Throws std::invalid_argument if the runs of `counts` do not fill an image of `size`.
void forEachCocoRun(std::string_view counts, cv::Size size, const std::function<void(int, int, int)>& visit);

/// The mask (0 or 255) of `size` that `counts` describes. Throws std::invalid_argument if the runs do not fill it.
[[nodiscard]] cv::Mat1b decodeCocoRle(std::string_view counts, cv::Size size);

}  // namespace saccade
