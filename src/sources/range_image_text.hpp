#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace saccade {

/// File name extension of range images in text, as POV-Ray renderings of ICL-NUIM come.
inline constexpr const char* kRangeImageTextExtension = ".depth";

/// Reads an image of `size` written as text, row by row, metres; a number too few or too many is an IoError.
void readRangeImageText(const std::filesystem::path& path, const cv::Size& size, cv::Mat1f& range_m);

}  // namespace saccade
