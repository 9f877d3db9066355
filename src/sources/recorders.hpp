#pragma once

#include <filesystem>
#include <memory>

#include "saccade/sources/recording.hpp"
#include "sources/stamp_units.hpp"

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

/// The 16-bit depth images of a recording: those of the sensor as they are; metres rounded to 1/5000 m.
class RecordedDepth {
 public:
  /// Units of all depth images: those of the calibration, or 5000 where the sensor measures in metres.
  explicit RecordedDepth(const RgbdCalibration& calibration);

  [[nodiscard]] double unitsPerMetre() const { return units_per_metre_; }
  /// The frame's depth in units; empty where it has none. Valid until the next call.
  [[nodiscard]] const cv::Mat1w& of(const SensorFrame& frame);
  /// True once metres were no whole units and had to be rounded.
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
