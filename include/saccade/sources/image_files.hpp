#pragma once

#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

namespace saccade {

/// What the first bytes of a PNG or JPEG file say, without decoding it.
struct ImageHeader {
  int width = 0;
  int height = 0;
  int channels = 0;          ///< 1, 2 (grey + alpha), 3 or 4; palette images count as 3
  int bits_per_channel = 0;  ///< as stored: 8 or 16, less in palettes and packed greys
};

/// Reads the colour, depth and label images of data sets, PNG and JPEG, strictly: a file that is truncated, of another
/// pixel type or damaged is an IoError that says so, never a partly grey image.
///
/// Owns the buffer of the file's bytes and reuses it; one instance per thread. Does not check image sizes.
class ImageReader {
 public:
  /// Reads the header only.
  [[nodiscard]] ImageHeader header(const std::filesystem::path& path);
  /// Reads an 8-bit image as BGR. A 16-bit one-channel image is refused with the hint that the lists look swapped.
  void readColor(const std::filesystem::path& path, cv::Mat3b& color);
  /// Reads a 16-bit one-channel image. An 8-bit image with several channels is refused with the same hint, an 8-bit
  /// one-channel image because such depth is a picture, not a measurement.
  void readDepth(const std::filesystem::path& path, cv::Mat1w& raw);
  /// Reads an 8 or 16-bit one-channel image of instance ids.
  void readLabel(const std::filesystem::path& path, cv::Mat1w& label);

 private:
  ImageHeader loadChecked(const std::filesystem::path& path);  // whole file into bytes_
  void decode(const std::filesystem::path& path, int flags, cv::Mat& image);

  std::vector<unsigned char> bytes_;
  cv::Mat decoded_;
};

}  // namespace saccade
