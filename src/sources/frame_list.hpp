#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "saccade/core/frame.hpp"
#include "saccade/sources/camera_calibration.hpp"
#include "saccade/sources/sensor_source.hpp"

namespace saccade {

/// Frame rate of layouts that store no stamps.
inline constexpr double kUsualFramesPerSecond = 30.0;

/// The calibration that every folder layout reads first, if it is there.
inline constexpr const char* kCalibrationFile = "camera.yaml";

/// Where the parts of one frame are; made once on opening, images are read later.
struct FrameFiles {
  FrameIndex index;  ///< place in the whole sequence
  std::string name;
  double stamp_s = 0.0;
  std::filesystem::path color;
  std::filesystem::path depth;                 ///< empty: the frame has none
  std::optional<std::filesystem::path> label;  ///< none: the frame has none
  std::optional<Pose> T_WC;
};

/// What a folder layout comes to: all frames in order, the sensor, and what there is to say about it.
struct FrameList {
  std::vector<FrameFiles> frames;
  RgbdCalibration calibration;
  SourceDescription description;  ///< kind, location, dropped, origins and remarks; the rest is filled on opening
};

/// 7-Scenes: `frame-NNNNNN.{color.png|jpg, depth.png, pose.txt}`.
[[nodiscard]] bool looksLikeSevenScenes(const std::filesystem::path& folder);
[[nodiscard]] FrameList listSevenScenes(const std::filesystem::path& folder);

/// TUM: `rgb.txt`, `depth.txt`, `groundtruth.txt` (may be missing).
[[nodiscard]] bool looksLikeTum(const std::filesystem::path& folder);
[[nodiscard]] FrameList listTum(const std::filesystem::path& folder);

/// Labelled frames: `color/NAME.{png|jpg}`, `depth/NAME.png`, `label/NAME.png`, `camera.txt`, `groundtruth.txt` (may be
/// missing).
[[nodiscard]] bool looksLikeLabelledFrames(const std::filesystem::path& folder);
[[nodiscard]] FrameList listLabelledFrames(const std::filesystem::path& folder);

/// ICL-NUIM: `rgb/ depth/ associations.txt *.freiburg`, or as POV-Ray renders it, `NAME_NNNN.{png, depth, txt}`.
[[nodiscard]] bool looksLikeIclNuim(const std::filesystem::path& folder);
[[nodiscard]] FrameList listIclNuim(const std::filesystem::path& folder);

/// ScanNet, as its SensReader exports: `color/N.jpg depth/N.png pose/N.txt intrinsic/intrinsic_{color,depth}.txt`.
[[nodiscard]] bool looksLikeScanNet(const std::filesystem::path& folder);
[[nodiscard]] FrameList listScanNet(const std::filesystem::path& folder);

/// RTAB-Map, as rtabmap-export and its viewer write: `[NAME_]rgb/ [NAME_]depth/ [NAME_]calib/`.
[[nodiscard]] bool looksLikeRtabMap(const std::filesystem::path& folder);
[[nodiscard]] FrameList listRtabMap(const std::filesystem::path& folder);

/// Redwood and Open3D: `{color,rgb,image}/ depth/`, an intrinsics JSON and a `.log` trajectory, both of which may be
/// missing.
[[nodiscard]] bool looksLikeRedwood(const std::filesystem::path& folder);
[[nodiscard]] FrameList listRedwood(const std::filesystem::path& folder);

/// Washington RGB-D Scenes: `NAME_N.png NAME_N_depth.png` (v1) or `N-color.png N-depth.png` (v2).
[[nodiscard]] bool looksLikeRgbdScenes(const std::filesystem::path& folder);
[[nodiscard]] FrameList listRgbdScenes(const std::filesystem::path& folder);

/// A plain folder whose `camera.yaml` says in `images:` where colour and depth are.
[[nodiscard]] bool looksLikePlainFolder(const std::filesystem::path& folder);
[[nodiscard]] FrameList listPlainFolder(const std::filesystem::path& folder);

/// The frames of a folder in the first layout above that it looks like. Throws IoError that says what was looked for
/// and what was found.
[[nodiscard]] FrameList listFolder(const std::filesystem::path& folder);

/// The folder's own `camera.yaml`, if it has one.
[[nodiscard]] std::optional<RgbdCalibration> findCalibrationFile(const std::filesystem::path& folder);
/// `camera` with the size of the first image that can be read among one part of the frames. Throws IoError if none can.
[[nodiscard]] PinholeCamera withSizeOf(PinholeCamera camera, const FrameList& list,
                                       std::filesystem::path FrameFiles::*part);
/// Settles the depth scale: what the calibration says, else `units_per_metre`, which `origin` gives the reason for.
void settleDepthScale(FrameList& list, double units_per_metre, const std::string& origin);
/// Adds one frame for every number that both maps hold, counts the others as dropped; stamps are number / 30 s.
/// Throws IoError if there is none.
void pairByNumber(const std::filesystem::path& folder, const std::map<std::int64_t, std::filesystem::path>& color,
                  const std::map<std::int64_t, std::filesystem::path>& depth, FrameList& list);
/// Adds a remark if some, but not all, frames have a pose.
void remarkMissingPoses(FrameList& list, const std::string& where);

/// Reads the frames of `list` that `range` selects. `labels`: see openSource().
[[nodiscard]] std::unique_ptr<SensorSource> openFrameList(FrameList list, const FrameRange& range,
                                                          const std::filesystem::path& labels);

/// "1 frame", "2 frames".
[[nodiscard]] inline std::string counted(std::int64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace saccade
