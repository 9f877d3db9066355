#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// A box to draw on the colour image.
struct BoxMark {
  cv::Rect box;            ///< pixels
  int rank = 0;            ///< 0 is the best; shown as a number
  bool inhibited = false;  ///< inhibited candidates are drawn thin and dark red, without a number
};

/// What one frame's picture shows. Images have the camera's size; an empty image leaves its panel black.
struct FramePanels {
  cv::Mat3b color;           ///< BGR
  cv::Mat1f saliency;        ///< [0, 1]
  cv::Mat1i color_segments;  ///< labels from 0, -1 none
  cv::Mat1i surface_segments;
  cv::Mat1b inhibited;   ///< 2D IOR map: non-zero where inhibited
  cv::Mat1i ior_weight;  ///< ticks until forgotten, shown as grey under the white of the inhibited pixels
  std::vector<BoxMark> boxes;
  std::string caption;
};

/// One picture of a frame, like the paper's figures 4, 6 and 12: the colour image with ranked boxes at full size, to
/// its right saliency, 2D IOR map, colour segments and surface segments at half size, below a line of text. Size: (2 ·
/// width) × (height + caption strip), both even as video codecs want.
[[nodiscard]] cv::Mat3b drawFramePicture(const FramePanels& panels);

/// Segment labels as distinct colours that depend only on the label; -1 is black.
[[nodiscard]] cv::Mat3b paintLabels(const cv::Mat1i& labels);

/// Colour of rank `rank` of `count`: from yellow for the best over green to blue for the last.
[[nodiscard]] cv::Scalar rankColor(int rank, int count);

}  // namespace saccade
