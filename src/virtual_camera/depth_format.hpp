#pragma once

#include <OniCTypes.h>
#include <OniPlatform.h>
#include <cstdint>

#include <opencv2/core.hpp>

#include "saccade/sources/camera_calibration.hpp"

namespace saccade::virtual_camera {

/// OpenNI2 stores depth in millimetres or in tenths of them: millimetres for sensors that count those, else tenths.
[[nodiscard]] OniPixelFormat depthFormatFor(const RgbdCalibration& calibration);
[[nodiscard]] double unitsPerMetre(OniPixelFormat format);

/// Depth in units of `format`; what is no measurement, or beyond 16 bits, is 0. `raw` counts the calibration's units;
/// where the calibration has none, it counts 1/5000 m. Returns the number of measurements that were beyond 16 bits.
std::int64_t toOpenNi2Depth(const cv::Mat1w& raw, const RgbdCalibration& calibration, OniPixelFormat format,
                            cv::Mat1w& depth);

}  // namespace saccade::virtual_camera
