#pragma once

#include <filesystem>
#include <memory>

#include <opencv2/core.hpp>

namespace saccade {

/// Writes pictures to an MP4 file (H.264 where the encoder is there, else MPEG-4 part 2) in fragments, so that whatever
/// was written stays readable when the program is killed.
class VideoWriter {
 public:
  /// Creates the file; pictures must then have exactly `size`, whose sides must be even.
  /// Throws IoError if the file cannot be made.
  VideoWriter(const std::filesystem::path& path, cv::Size size, double frames_per_second);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Appends one picture. Throws IoError when the disk is full or the encoder fails.
  void write(const cv::Mat3b& bgr);
  /// Writes what the encoder still holds and closes the file. Throws IoError as write() does.
  void finish();

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace saccade
