#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "saccade/sources/sensor_source.hpp"

namespace saccade {

/// The kinds of recordings in one file. Each function throws one clear IoError where this build lacks the library.
[[nodiscard]] std::unique_ptr<SensorSource> openRawlog(const std::filesystem::path& file, const FrameRange& range);
[[nodiscard]] std::unique_ptr<SensorSource> openBag(const std::filesystem::path& file, const FrameRange& range);
[[nodiscard]] std::unique_ptr<SensorSource> openOni(const std::filesystem::path& file, const FrameRange& range);

/// A live OpenNI2 camera; `uri` empty: the first.
[[nodiscard]] std::unique_ptr<SensorSource> openOpenNi2(const std::string& uri, const FrameRange& range);

/// The calibration `FILE.yaml` beside a recording, which is taken before what the recording itself says.
[[nodiscard]] std::optional<RgbdCalibration> findSideCalibration(const std::filesystem::path& file);

/// The place of `--range` among frames whose number is not known in advance.
class RangeCursor {
 public:
  explicit RangeCursor(const FrameRange& range) : range_(range) {}
  /// Counts one frame of the input; true if it is selected.
  [[nodiscard]] bool take() {
    const std::int64_t index = next_++;
    return index >= range_.first && (index - range_.first) % range_.step == 0 && !(range_.end && index >= *range_.end);
  }
  /// Index of the frame that take() counted last.
  [[nodiscard]] FrameIndex last() const { return {next_ - 1}; }
  /// True if no later frame can be selected.
  [[nodiscard]] bool passed() const { return range_.end && next_ >= *range_.end; }

 private:
  FrameRange range_;
  std::int64_t next_ = 0;
};

}  // namespace saccade
