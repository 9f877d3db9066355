#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "sources/bag_messages.hpp"

namespace saccade {

/// Images of ROS messages as BGR, and depth as raw millimetres (16UC1) or metres (32FC1). Each returns what is wrong
/// with the message, or an empty text.
[[nodiscard]] std::string readColor(const ImageMessage& message, cv::Mat3b& color);
[[nodiscard]] std::string readColor(const CompressedImageMessage& message, cv::Mat3b& color);
[[nodiscard]] std::string readDepth(const ImageMessage& message, cv::Mat1w& raw_mm, cv::Mat1f& depth_m);
[[nodiscard]] std::string readDepth(const CompressedImageMessage& message, cv::Mat1w& raw_mm, cv::Mat1f& depth_m);

}  // namespace saccade
