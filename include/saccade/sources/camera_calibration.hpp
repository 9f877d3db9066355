#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/core/lens_distortion.hpp"

namespace saccade {

/// The depth camera D of a sensor whose depth image is not registered to colour.
struct DepthCamera {
  PinholeCamera camera;
  LensDistortion distortion;
  Pose T_CD = Pose::Identity();  ///< takes depth-camera points to the colour camera (`T_color_depth` in files)
};

/// Everything a source must know to make ideal RGB-D frames from the images of one sensor.
struct RgbdCalibration {
  PinholeCamera color;                       ///< width and height may be 0: then the images tell
  LensDistortion color_distortion;           ///< removed when colour is read
  std::optional<DepthCamera> depth;          ///< none: depth is registered to colour already
  double depth_units_per_metre = 0.0;        ///< 0: the file does not say
  bool depth_along_ray = false;              ///< depth is the distance from the camera's centre, not along its axis
  std::vector<std::uint16_t> depth_invalid;  ///< raw values that mean "no measurement", beside 0 and 65535
  std::string origin;                        ///< the file, or the default and why it was taken
};

/// Reads a YAML calibration. Two layouts: `color: {width, height, fx, fy, cx, cy, distortion: [k1 k2 p1 p2 k3]}` with
/// `depth: {same, units_per_metre, invalid: [...], along_ray}` and `T_color_depth` (4x4, takes depth-camera points to
/// the colour camera, metres); or flat `fx fy cx cy width height depth_units_per_metre distortion`, which may be
/// followed by the same `depth` and `T_color_depth`. Throws IoError.
[[nodiscard]] RgbdCalibration loadCalibrationYaml(const std::filesystem::path& path);

/// The same from the text of a YAML; `path` is what errors name.
[[nodiscard]] RgbdCalibration parseCalibrationYaml(const std::string& yaml, const std::filesystem::path& path);

/// The YAML that loadCalibrationYaml() reads back to the same numbers.
[[nodiscard]] std::string calibrationYaml(const RgbdCalibration& calibration);

/// Reads a `camera.txt`: one line `fx fy cx cy width height depth_units_per_metre`, lines that start with # are
/// comments. Throws IoError.
[[nodiscard]] RgbdCalibration loadCameraText(const std::filesystem::path& path);

/// Reads a 3x3 intrinsic matrix as text (7-Scenes `camera-intrinsics.txt`); width and height stay 0. Throws IoError.
[[nodiscard]] RgbdCalibration loadIntrinsicMatrix(const std::filesystem::path& path);

}  // namespace saccade
