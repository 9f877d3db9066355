#include "saccade/sources/sensor_source.hpp"

#include <array>
#include <fstream>
#include <stdexcept>

#include "saccade/core/errors.hpp"
#include "saccade/simulation/simulated_source.hpp"
#include "sources/frame_list.hpp"
#include "sources/frames_as_sensor.hpp"
#include "sources/recording_files.hpp"

namespace saccade {
namespace {

struct Layout {
  const char* files;
  bool (*matches)(const std::filesystem::path&);
  FrameList (*list)(const std::filesystem::path&);
};

// The first that matches is taken, so the more particular come first.
constexpr std::array kLayouts = {
    Layout{"camera.yaml with images: (plain folder)", looksLikePlainFolder, listPlainFolder},
    Layout{"frame-NNNNNN.color.png (7-Scenes)", looksLikeSevenScenes, listSevenScenes},
    Layout{"rgb.txt and depth.txt (TUM)", looksLikeTum, listTum},
    Layout{"associations.txt and *.freiburg, or *.depth (ICL-NUIM)", looksLikeIclNuim, listIclNuim},
    Layout{"color/, depth/ and intrinsic/ (ScanNet)", looksLikeScanNet, listScanNet},
    Layout{"rgb/, depth/ and calib/ (RTAB-Map)", looksLikeRtabMap, listRtabMap},
    Layout{"N-color.png and N-depth.png, or NAME_N_depth.png (RGB-D Scenes)", looksLikeRgbdScenes, listRgbdScenes},
    Layout{"color/, depth/ and intrinsics.json (Redwood, Open3D)", looksLikeRedwood, listRedwood},
    Layout{"color/, depth/ and camera.txt (labelled frames)", looksLikeLabelledFrames, listLabelledFrames},
};

std::string contents(const std::filesystem::path& folder) {
  constexpr int kShown = 6;
  std::string names;
  std::int64_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (++count <= kShown) names += (names.empty() ? "" : ", ") + entry.path().filename().string();
  }
  if (count == 0) return "an empty folder";
  return counted(count, "entry") + ": " + names + (count > kShown ? ", ..." : "");
}

constexpr const char* kCameraPrefix = "openni2:";

/// Opens a recording in one file; the first bytes tell the kind, whatever its name.
std::unique_ptr<SensorSource> openFile(const std::filesystem::path& path, const FrameRange& range) {
  std::ifstream file(path, std::ios::binary);
  std::string head(16, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  if (head.starts_with("#ROSBAG V2.0")) return openBag(path, range);
  if (head.starts_with("NI10")) return openOni(path, range);
  // Rawlogs may be packed, or not; inside they have no mark of their own.
  if (head.starts_with("\x1f\x8b") || path.extension() == ".rawlog") return openRawlog(path, range);
  throw IoError(path, "a folder of frames, or a recording of OpenNI2 (.oni), MRPT (.rawlog) or ROS 1 (.bag)",
                head.empty() ? "a file that is empty or cannot be read" : "a file of another kind");
}

}  // namespace

FrameList listFolder(const std::filesystem::path& folder) {
  std::string looked_for;
  for (const Layout& layout : kLayouts) {
    looked_for += (looked_for.empty() ? "" : "; or ") + std::string(layout.files);
    if (!layout.matches(folder)) continue;
    FrameList list = layout.list(folder);
    list.description.location = folder.string();
    return list;
  }
  throw IoError(folder, looked_for, contents(folder));
}

std::optional<RgbdCalibration> findSideCalibration(const std::filesystem::path& file) {
  std::filesystem::path side = file;
  side += ".yaml";
  if (!std::filesystem::exists(side)) return std::nullopt;
  return loadCalibrationYaml(side);
}

std::unique_ptr<SensorSource> openSensorSource(const std::string& input, const FrameRange& range,
                                               const std::filesystem::path& labels) {
  if (range.first < 0 || range.step < 1) {
    throw std::invalid_argument("frame range: expected first >= 0 and step >= 1, found " + std::to_string(range.first) +
                                " and " + std::to_string(range.step));
  }
  if (SimulationRequest::matches(input)) return std::make_unique<FramesAsSensor>(openSource(input, range, labels));
  const bool camera = input.starts_with(kCameraPrefix);
  const std::filesystem::path path(input);
  std::error_code error;
  if (!camera && !std::filesystem::exists(path, error)) {
    throw IoError(path, "a folder of RGB-D frames, a recording, openni2: or sim:SCENE", "nothing of that name");
  }
  if (!camera && std::filesystem::is_directory(path, error)) return openFrameList(listFolder(path), range, labels);
  if (!labels.empty()) throw IoError(labels, "labels for a folder of frames", "labels for another kind of input");
  if (camera) return openOpenNi2(input.substr(std::string(kCameraPrefix).size()), range);
  return openFile(path, range);
}

}  // namespace saccade
