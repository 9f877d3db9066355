#pragma once

#include <OniCTypes.h>
#include <OniPlatform.h>
#include <cstdint>
#include <optional>
#include <string>

namespace saccade::virtual_camera {

struct ImageSize {
  int width = 0;
  int height = 0;
};

struct FocalLength {
  double fx_px = 0.0;
  double fy_px = 0.0;
};

/// What the URI of a virtual camera asks for.
struct VirtualCameraRequest {
  std::string uri;
  std::string input;                         ///< any input of saccade; "push": none, the camera is fed
  double speed = 1.0;                        ///< `speed`: of playing, against the input's own stamps
  std::optional<std::int64_t> unplug_after;  ///< `unplug_after`: frames, then the camera goes away
  std::optional<double> replug_after_s;      ///< `replug_after`: and comes back so many seconds later, once
  ImageSize color, depth;                    ///< `color`, `depth`: of a camera that is fed, WIDTHxHEIGHT
  FocalLength color_focal, depth_focal;      ///< `color_focal`, `depth_focal`: of a camera that is fed, FXxFY
  OniPixelFormat depth_format = ONI_PIXEL_FORMAT_DEPTH_1_MM;  ///< `unit`: "mm" or "100um", of a camera that is fed

  [[nodiscard]] bool isFed() const;
  /// Parses `saccade:INPUT#key=value&key=value`; none if it is no such URI or a value is bad.
  [[nodiscard]] static std::optional<VirtualCameraRequest> parse(const std::string& uri);
};

}  // namespace saccade::virtual_camera
