#pragma once

#include <cstdint>

/// What the library and the virtual camera, an OpenNI2 driver, say to each other through OpenNI2.
namespace saccade::virtual_camera {

/// URIs of virtual cameras begin so: `saccade:INPUT#key=value&...`, or `saccade:push#...` for one that is fed.
inline constexpr const char* kUriPrefix = "saccade:";
inline constexpr const char* kPushName = "push";

/// Device property: the full calibration as YAML text.
inline constexpr int kCalibrationProperty = 0x5acc0001;
inline constexpr int kMostCalibrationBytes = 4096;
/// Device command of a camera that is fed: hands a PushedFrame over, which is copied before the command returns.
inline constexpr int kPushCommand = 0x5acc0002;
/// Device command of a camera that is fed: takes some bytes that end up in a recording behind all that was sent before.
/// ONI_STATUS_OUT_OF_FLOW until the recorder has taken note of both streams.
inline constexpr int kMarkCommand = 0x5acc0003;

struct PushedFrame {
  const std::uint8_t* rgb = nullptr;     ///< rows without gaps, of the colour stream's size
  const std::uint16_t* depth = nullptr;  ///< in the depth stream's unit; null: this frame has none
  std::int64_t stamp_us = 0;  ///< OpenNI2 itself counts without sign; differences come out right all the same
};

}  // namespace saccade::virtual_camera
