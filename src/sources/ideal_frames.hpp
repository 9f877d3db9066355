#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "saccade/sources/depth_registration.hpp"
#include "saccade/sources/sensor_source.hpp"
#include "saccade/sources/undistortion.hpp"

namespace saccade {

/// Raw depth at its ceiling: no measurement, whatever the sensor.
inline constexpr std::uint16_t kSaturatedDepth = 65535;

/// Makes ideal RGB-D frames of a sensor's: colour and labels without lens distortion, depth in metres along the optical
/// axis and rendered into the colour camera. What that takes is said by the sensor's calibration; one that asks for
/// nothing is passed on without a copy.
class IdealFrames final : public FrameSource {
 public:
  explicit IdealFrames(std::unique_ptr<SensorSource> sensor);

  [[nodiscard]] const SourceDescription& description() const override { return sensor_->description(); }
  [[nodiscard]] ReadStatus read(RgbdFrame& frame) override;
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }
  [[nodiscard]] SourceProgress progress() const override { return sensor_->progress(); }

 private:
  [[nodiscard]] bool toMetres(RgbdFrame& frame);  // false: nothing was measured

  std::unique_ptr<SensorSource> sensor_;
  std::string skip_reason_;
  std::optional<Undistortion> undistortion_;       // only where colour is distorted
  std::optional<DepthRegistration> registration_;  // only where depth is not in C's pixels
  cv::Mat1f axis_share_;                           // only where depth is along the ray: z of the unit ray per pixel
  SensorFrame raw_;
  cv::Mat1f depth_D_m_;
};

/// Fills what a description says about cameras and depth from the calibration; adds remarks on what is corrected.
void describeCalibration(const RgbdCalibration& calibration, SourceDescription& description);

}  // namespace saccade
