#pragma once

#include <vector>

#include <opencv2/core.hpp>

/// Object proposals of OpenCV, to be judged beside ours on the same frames.
namespace saccade {

/// Boxes of Selective Search (Uijlings et al. 2013) in its fast mode, in OpenCV's order. About 2 s for 640x480.
[[nodiscard]] std::vector<cv::Rect> selectiveSearchBoxes(const cv::Mat3b& bgr);

/// At most 1000 boxes of Edge Boxes (Zitnick and Dollar 2014) by falling score. The edges are those of a Sobel filter
/// on the smoothed colours, thinned by non-maximum suppression: the trained edge model of the paper is in no Debian
/// package. About 0.3 s for 640x480.
[[nodiscard]] std::vector<cv::Rect> edgeBoxes(const cv::Mat3b& bgr);

}  // namespace saccade
