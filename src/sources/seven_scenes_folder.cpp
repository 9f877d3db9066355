#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <string_view>

#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"
#include "sources/pose_lines.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

constexpr std::string_view kPrefix = "frame-";

struct Part {
  std::int64_t number = 0;
  std::string stem;    // "frame-000012"
  std::string suffix;  // "color.jpg"
};

std::optional<Part> parseName(const std::string& name) {
  if (!name.starts_with(kPrefix)) return std::nullopt;
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos || dot == kPrefix.size()) return std::nullopt;
  Part part;
  const auto [end, error] = std::from_chars(name.data() + kPrefix.size(), name.data() + dot, part.number);
  if (error != std::errc() || end != name.data() + dot) return std::nullopt;
  part.stem = name.substr(0, dot);
  part.suffix = name.substr(dot + 1);
  return part;
}

bool isColor(const std::string& suffix) {
  return suffix == "color.png" || suffix == "color.jpg" || suffix == "color.jpeg";
}

RgbdCalibration findCalibration(const std::filesystem::path& folder, std::vector<std::string>& remarks) {
  if (std::filesystem::exists(folder / kCalibrationFile)) return loadCalibrationYaml(folder / kCalibrationFile);
  remarks.emplace_back(
      "no camera.yaml: depth is taken as registered to colour, although the Kinect of 7-Scenes does not register it");
  if (std::filesystem::exists(folder / "camera-intrinsics.txt")) {
    return loadIntrinsicMatrix(folder / "camera-intrinsics.txt");
  }
  RgbdCalibration usual;
  usual.color = {0, 0, 585.0, 585.0, 320.0, 240.0};
  usual.origin = "the intrinsics published with 7-Scenes, as the folder has no camera-intrinsics.txt";
  return usual;
}

/// Stamps by frame name from `timestamps.txt`, which recordings of ours have beside the layout's own files.
std::map<std::string, double> readStamps(const std::filesystem::path& folder) {
  std::map<std::string, double> stamps;
  const std::filesystem::path path = folder / "timestamps.txt";
  std::ifstream file(path);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string_view> words = splitWords(line);
    if (words.empty() || words[0].front() == '#') continue;
    const std::optional<double> stamp_s = words.size() == 2 ? parseNumber(words[1]) : std::nullopt;
    if (!stamp_s || !std::isfinite(*stamp_s)) {
      throw IoError(path, "\"frame seconds\" in line " + std::to_string(number), inQuotes(line));
    }
    stamps[std::string(words[0])] = *stamp_s;
  }
  return stamps;
}

}  // namespace

bool looksLikeSevenScenes(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::optional<Part> part = parseName(entry.path().filename().string());
    if (part && isColor(part->suffix)) return true;
  }
  return false;
}

FrameList listSevenScenes(const std::filesystem::path& folder) {
  std::map<std::int64_t, FrameFiles> found;  // by number: the order of the sequence
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::optional<Part> part = parseName(entry.path().filename().string());
    if (!part) continue;
    FrameFiles& files = found[part->number];
    files.name = part->stem;
    files.stamp_s = static_cast<double>(part->number) / kUsualFramesPerSecond;
    if (isColor(part->suffix)) files.color = entry.path();
    if (part->suffix == "depth.png") files.depth = entry.path();
  }

  const std::map<std::string, double> stamps = readStamps(folder);
  for (auto& [number, files] : found) {
    if (const auto stamp = stamps.find(files.name); stamp != stamps.end()) files.stamp_s = stamp->second;
  }

  FrameList list;
  list.description.kind = "7-Scenes folder";
  list.calibration = findCalibration(folder, list.description.remarks);
  if (list.calibration.depth_units_per_metre > 0) {
    list.description.depth_scale_origin = list.calibration.origin;
  } else {
    list.calibration.depth_units_per_metre = 1000.0;
    list.description.depth_scale_origin = "7-Scenes depth is in millimetres";
  }

  const Pose T_DC = list.calibration.depth ? list.calibration.depth->T_CD.inverse() : Pose::Identity();
  std::int64_t without_pose = 0;
  for (auto& [number, files] : found) {
    if (files.color.empty() || files.depth.empty()) {
      list.description.dropped += (files.color.empty() ? 0 : 1) + (files.depth.empty() ? 0 : 1);
      continue;
    }
    // The poses of 7-Scenes are KinectFusion's: of the depth camera.
    const std::optional<Pose> T_WD = readPoseMatrix(folder / (files.name + ".pose.txt"));
    if (T_WD) files.T_WC = *T_WD * T_DC;
    without_pose += T_WD ? 0 : 1;
    list.frames.push_back(std::move(files));
  }
  if (without_pose > 0) {
    list.description.remarks.push_back(counted(without_pose, "frame") + " without a usable pose.txt");
  }
  if (list.frames.empty()) {
    throw IoError(folder, "pairs frame-NNNNNN.color.png and frame-NNNNNN.depth.png",
                  "no complete pair among " + counted(static_cast<std::int64_t>(found.size()), "frame"));
  }
  return list;
}

}  // namespace saccade
