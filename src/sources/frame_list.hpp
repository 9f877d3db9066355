#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "saccade/core/frame.hpp"
#include "saccade/sources/camera_calibration.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {

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

/// Reads the frames of `list` that `range` selects. `labels`: see openSource().
[[nodiscard]] std::unique_ptr<FrameSource> openFrameList(FrameList list, const FrameRange& range,
                                                         const std::filesystem::path& labels);

/// "1 frame", "2 frames".
[[nodiscard]] inline std::string counted(std::int64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace saccade
