#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>

/// The images of a keyframe as they lie in a session.
namespace saccade {

struct PackedDepth {
  std::string bytes;    ///< PNG, 16 bit, 0 = no measurement
  double unit_m = 0.0;  ///< metres a step
};

/// JPEG, quality 90; empty for an empty image.
[[nodiscard]] std::string packColor(const cv::Mat3b& color);
/// In steps of 0.25 mm, or of 1 mm where something is farther than 16 m; empty for an empty image.
[[nodiscard]] PackedDepth packDepth(const cv::Mat1f& depth_m);

/// The images again, which must be of `size`, or empty for no bytes. A header that announces another size is refused
/// before anything is unpacked. Throws IoError(path, ...).
[[nodiscard]] cv::Mat3b unpackColor(std::string_view jpeg, cv::Size size, const std::filesystem::path& path);
[[nodiscard]] cv::Mat1f unpackDepth(std::string_view png, double unit_m, cv::Size size,
                                    const std::filesystem::path& path);

}  // namespace saccade
