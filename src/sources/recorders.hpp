#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "saccade/sources/recording.hpp"

namespace saccade {

/// The writers behind openRecording(), one for each kind.
[[nodiscard]] std::unique_ptr<RecordingWriter> makeTumRecorder(const std::filesystem::path& folder,
                                                               const RgbdCalibration& calibration);
[[nodiscard]] std::unique_ptr<RecordingWriter> makeSevenScenesRecorder(const std::filesystem::path& folder,
                                                                       const RgbdCalibration& calibration);
[[nodiscard]] std::unique_ptr<RecordingWriter> makeRawlogRecorder(const std::filesystem::path& file,
                                                                  const RgbdCalibration& calibration);
[[nodiscard]] std::unique_ptr<RecordingWriter> makeBagRecorder(const std::filesystem::path& file,
                                                               const RgbdCalibration& calibration);
[[nodiscard]] std::unique_ptr<RecordingWriter> makeOniRecorder(const std::filesystem::path& file,
                                                               const RgbdCalibration& calibration);

/// A stamp as a whole number of units, as a container keeps it.
[[nodiscard]] inline std::int64_t stampIn(long double units_per_second, double stamp_s) {
  return static_cast<std::int64_t>(std::llround(static_cast<long double>(stamp_s) * units_per_second));
}
inline constexpr long double kMicroseconds = 1e6L;  // per second; OpenNI2
inline constexpr long double kMrptTicks = 1e7L;
inline constexpr long double kNanoseconds = 1e9L;  // ROS

/// The double nearest to a stamp of so many units; the same as reading it as decimal text.
[[nodiscard]] inline double secondsOf(std::int64_t count, long double units_per_second) {
  return static_cast<double>(static_cast<long double>(count) / units_per_second);
}

/// The 16-bit depth images of a recording: those of the sensor as they are; metres rounded to 1/5000 m.
class RecordedDepth {
 public:
  /// Units of all depth images: those of the calibration, or 5000 where the sensor measures in metres.
  explicit RecordedDepth(const RgbdCalibration& calibration);

  [[nodiscard]] double unitsPerMetre() const { return units_per_metre_; }
  /// The frame's depth in units; empty where it has none. Valid until the next call.
  [[nodiscard]] const cv::Mat1w& of(const SensorFrame& frame);
  /// True once metres had to be rounded.
  [[nodiscard]] bool rounded() const { return rounded_; }

 private:
  double units_per_metre_;
  bool rounded_ = false;
  cv::Mat1w raw_;
};

/// A file that is written as `NAME.partial` and gets its name when it is whole.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path path);
  /// Gives the file its name. Throws IoError.
  void complete();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& partialPath() const { return partial_; }

 private:
  std::filesystem::path path_, partial_;
};

}  // namespace saccade
