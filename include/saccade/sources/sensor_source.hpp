#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "saccade/core/frame.hpp"
#include "saccade/sources/camera_calibration.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {

/// What a sensor gave at one moment, as it is stored: lenses still distort, depth is still the depth camera's.
struct SensorFrame {
  FrameIndex index;
  std::string name;  ///< stem of the colour file, or a running name for inputs without files
  double stamp_s = 0.0;
  cv::Mat3b color;           ///< BGR, of the colour camera's size
  cv::Mat1w raw_depth;       ///< units of the calibration, 0 and 65535 = no measurement; empty: see `depth_m`
  cv::Mat1f depth_m;         ///< where the input stores metres; 0, negative, NaN and infinite = no measurement
  cv::Mat1w label;           ///< instance id per pixel of `color`; empty where the input has none
  std::optional<Pose> T_WC;  ///< pose of the colour camera that the input itself gives

  [[nodiscard]] bool hasDepth() const { return !raw_depth.empty() || !depth_m.empty(); }
};

/// A sensor or a recording of one, read in order, with everything it takes to make ideal frames of its images or to
/// write them elsewhere without loss. Not thread-safe. Opening one that cannot work throws IoError; a single bad frame
/// is kSkip. See FrameSource for how readers are told what happens.
class SensorSource {
 public:
  virtual ~SensorSource() = default;

  /// Both cameras; image sizes are known.
  [[nodiscard]] virtual const RgbdCalibration& calibration() const = 0;
  [[nodiscard]] virtual const SourceDescription& description() const = 0;
  /// Reads the next frame into `frame`, reusing its buffers.
  [[nodiscard]] virtual ReadStatus read(SensorFrame& frame) = 0;
  [[nodiscard]] virtual const std::string& skipReason() const = 0;
  [[nodiscard]] virtual SourceProgress progress() const { return {}; }
};

/// Opens the same inputs as openSource(), which is this one with lens distortion removed and depth registered.
[[nodiscard]] std::unique_ptr<SensorSource> openSensorSource(const std::string& input, const FrameRange& range = {},
                                                             const std::filesystem::path& labels = {});

}  // namespace saccade
