#include "sources/ideal_frames.hpp"

#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "saccade/core/multiversion.hpp"
#include "sources/stamp_units.hpp"

namespace saccade {
namespace {

/// Raw depth in metres; the values of `invalid` become 0. Returns whether anything was measured.
SACCADE_MULTIVERSION
bool convertRaw(const std::uint16_t* raw, std::size_t count, float metres_per_unit, const std::uint16_t* invalid,
                std::size_t invalid_count, float* depth_m) {
  std::uint16_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint16_t value = raw[i] == kSaturatedDepth ? std::uint16_t{0} : raw[i];
    any = static_cast<std::uint16_t>(any | value);
    depth_m[i] = static_cast<float>(value) * metres_per_unit;
  }
  for (std::size_t k = 0; k < invalid_count; ++k) {
    for (std::size_t i = 0; i < count; ++i) depth_m[i] = raw[i] == invalid[k] ? 0.0f : depth_m[i];
  }
  return any != 0;
}

/// The same for depth that is stored in metres: whatever is not a measurement becomes 0.
bool convertMetres(const float* stored_m, std::size_t count, float* depth_m) {
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) {
    const bool measured = stored_m[i] > 0.0f && stored_m[i] <= std::numeric_limits<float>::max();
    depth_m[i] = measured ? stored_m[i] : 0.0f;
    any |= measured;
  }
  return any;
}

/// z of the unit ray behind each pixel: depth = distance * this.
cv::Mat1f axisShares(const PinholeCamera& camera, const LensDistortion& distortion) {
  cv::Mat1f shares(camera.height, camera.width);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto [x, y] = distortion.undistort((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      shares(v, u) = static_cast<float>(1.0 / std::sqrt(1.0 + x * x + y * y));
    }
  }
  return shares;
}

}  // namespace

IdealFrames::IdealFrames(std::unique_ptr<SensorSource> sensor) : sensor_(std::move(sensor)) {
  const RgbdCalibration& calibration = sensor_->calibration();
  const DistortedCamera& real = sensor_->description().color_camera;
  const PinholeCamera& ideal = sensor_->description().camera;
  // Depth that is registered to colour lies in the pixels of the distorted image: its rays are the colour lens'.
  const DepthCamera depth = calibration.depth.value_or(DepthCamera{real.camera, real.distortion, Pose::Identity()});
  if (!real.distortion.isZero()) undistortion_.emplace(ideal, real);
  if (calibration.depth || undistortion_) registration_.emplace(ideal, depth);
  if (calibration.depth_along_ray) axis_share_ = axisShares(depth.camera, depth.distortion);
}

ReadStatus IdealFrames::read(RgbdFrame& frame) {
  // Colour and labels that need no work are decoded straight into the frame's buffers.
  if (!undistortion_) {
    std::swap(raw_.color, frame.color);
    std::swap(raw_.label, frame.label);
  }
  const ReadStatus status = sensor_->read(raw_);
  if (!undistortion_) {
    std::swap(raw_.color, frame.color);
    std::swap(raw_.label, frame.label);
  }
  if (status == ReadStatus::kEnd) return status;
  frame.index = raw_.index;
  frame.name = raw_.name;
  frame.stamp_s = inWholeMicroseconds(raw_.stamp_s);
  frame.T_WC = raw_.T_WC;
  if (status == ReadStatus::kSkip) {
    skip_reason_ = sensor_->skipReason();
    return status;
  }
  if (undistortion_) {
    undistortion_->undistort(raw_.color, frame.color);
    if (raw_.label.empty()) {
      frame.label.release();
    } else {
      undistortion_->undistort(raw_.label, frame.label);
    }
  }
  if (!raw_.hasDepth()) {
    frame.depth_m.release();
    return status;
  }
  if (toMetres(frame)) return status;
  skip_reason_ = sensor_->description().location + ", frame " + frame.name +
                 ": expected some pixels with a depth measurement, found none";
  return ReadStatus::kSkip;
}

bool IdealFrames::toMetres(RgbdFrame& frame) {
  const RgbdCalibration& calibration = sensor_->calibration();
  cv::Mat1f& depth_m = registration_ ? depth_D_m_ : frame.depth_m;
  bool measured = false;
  if (raw_.raw_depth.empty()) {
    depth_m.create(raw_.depth_m.size());
    measured = convertMetres(raw_.depth_m[0], raw_.depth_m.total(), depth_m[0]);
  } else {
    depth_m.create(raw_.raw_depth.size());
    measured = convertRaw(raw_.raw_depth[0], raw_.raw_depth.total(),
                          static_cast<float>(1.0 / calibration.depth_units_per_metre), calibration.depth_invalid.data(),
                          calibration.depth_invalid.size(), depth_m[0]);
  }
  if (!axis_share_.empty()) cv::multiply(depth_m, axis_share_, depth_m);
  if (registration_) registration_->render(depth_D_m_, frame.depth_m);
  return measured;
}

void describeCalibration(const RgbdCalibration& calibration, SourceDescription& description) {
  description.color_camera = {calibration.color, calibration.color_distortion};
  description.camera = idealCameraOf(description.color_camera);
  description.intrinsics_origin = calibration.origin;
  description.depth_units_per_metre = calibration.depth_units_per_metre;
  description.depth_was_registered = !calibration.depth;
  if (calibration.depth_along_ray) description.remarks.emplace_back("depth is measured along the rays, not the axis");
  if (calibration.depth) description.remarks.emplace_back("depth is rendered into the colour camera");
  if (!calibration.color_distortion.isZero()) {
    std::ostringstream remark;
    remark << "lens distortion of colour is removed";
    if (description.camera != calibration.color) {
      remark.precision(1);
      remark << std::fixed << "; fx " << calibration.color.fx << " becomes " << description.camera.fx
             << ", so that no pixel is lost";
    }
    description.remarks.push_back(remark.str());
  }
}

}  // namespace saccade
