#include "virtual_camera/depth_format.hpp"

#include <algorithm>
#include <cmath>

#include "sources/recorders.hpp"

namespace saccade::virtual_camera {

OniPixelFormat depthFormatFor(const RgbdCalibration& calibration) {
  return RecordedDepth(calibration).unitsPerMetre() == 1000.0 ? ONI_PIXEL_FORMAT_DEPTH_1_MM
                                                              : ONI_PIXEL_FORMAT_DEPTH_100_UM;
}

double unitsPerMetre(OniPixelFormat format) {
  return format == ONI_PIXEL_FORMAT_DEPTH_100_UM ? 10000.0 : 1000.0;
}

std::int64_t toOpenNi2Depth(const cv::Mat1w& raw, const RgbdCalibration& calibration, OniPixelFormat format,
                            cv::Mat1w& depth) {
  const double scale = unitsPerMetre(format) / RecordedDepth(calibration).unitsPerMetre();
  const std::vector<std::uint16_t>& invalid = calibration.depth_invalid;
  std::int64_t beyond = 0;
  depth.create(raw.size());
  std::transform(raw.begin(), raw.end(), depth.begin(), [&](std::uint16_t value) {
    if (value == 0 || value == 65535 || std::find(invalid.begin(), invalid.end(), value) != invalid.end()) return 0;
    const double scaled = std::round(value * scale);
    if (scaled < 65535.0) return static_cast<int>(scaled);
    ++beyond;
    return 0;
  });
  return beyond;
}

}  // namespace saccade::virtual_camera
