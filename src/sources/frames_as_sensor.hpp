#pragma once

#include <memory>
#include <utility>

#include "saccade/sources/sensor_source.hpp"

namespace saccade {

/// Hands ideal frames, a simulation's, out as those of a sensor without distortion that measures in metres.
class FramesAsSensor final : public SensorSource {
 public:
  explicit FramesAsSensor(std::unique_ptr<FrameSource> frames) : frames_(std::move(frames)) {
    calibration_.color = frames_->description().camera;
    calibration_.depth_units_per_metre = frames_->description().depth_units_per_metre;
    calibration_.origin = frames_->description().intrinsics_origin;
  }

  [[nodiscard]] const RgbdCalibration& calibration() const override { return calibration_; }
  [[nodiscard]] const SourceDescription& description() const override { return frames_->description(); }
  [[nodiscard]] const std::string& skipReason() const override { return frames_->skipReason(); }
  [[nodiscard]] SourceProgress progress() const override { return frames_->progress(); }

  [[nodiscard]] ReadStatus read(SensorFrame& frame) override {
    const ReadStatus status = frames_->read(buffer_);
    frame.index = buffer_.index;
    frame.name = buffer_.name;
    frame.stamp_s = buffer_.stamp_s;
    frame.T_WC = buffer_.T_WC;
    frame.raw_depth.release();
    std::swap(frame.color, buffer_.color);
    std::swap(frame.depth_m, buffer_.depth_m);
    std::swap(frame.label, buffer_.label);
    return status;
  }

 private:
  std::unique_ptr<FrameSource> frames_;
  RgbdCalibration calibration_;
  RgbdFrame buffer_;
};

}  // namespace saccade
