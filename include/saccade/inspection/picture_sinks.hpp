#pragma once

#include <filesystem>
#include <memory>

#include "saccade/inspection/frame_picture.hpp"
#include "saccade/inspection/video_writer.hpp"
#include "saccade/pipeline/frame_sink.hpp"

namespace saccade {

/// The panels of a processed frame: ranked boxes of the attended candidates, saliency, segments, 2D IOR map.
[[nodiscard]] FramePanels panelsOf(const RgbdFrame& frame, const FrameReport& report);

/// Writes each frame's picture to an MP4 video that stays readable when the program is killed.
class VideoSink final : public FrameSink {
 public:
  /// Throws IoError if the file cannot be made; the video itself begins with the first frame, whose size it takes.
  VideoSink(const std::filesystem::path& path, double frames_per_second);

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  void finish() override;

 private:
  std::filesystem::path path_;
  double frames_per_second_;
  std::unique_ptr<VideoWriter> writer_;
};

/// Writes each frame's picture to `FOLDER/NAME.png`.
class PictureFolderSink final : public FrameSink {
 public:
  /// Makes the folder if it is missing. Throws IoError if that fails.
  explicit PictureFolderSink(const std::filesystem::path& folder);

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  void finish() override {}

 private:
  std::filesystem::path folder_;
};

}  // namespace saccade
