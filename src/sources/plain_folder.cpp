#include <algorithm>
#include <fstream>

#include <yaml-cpp/yaml.h>

#include "saccade/core/errors.hpp"
#include "saccade/sources/stamped_poses.hpp"
#include "sources/frame_list.hpp"
#include "sources/image_names.hpp"

namespace saccade {
namespace {

/// The `images:` part of a camera.yaml.
struct ImagesEntry {
  std::filesystem::path color, depth;  ///< folders, relative to the YAML
  std::string pair_by = "number";      ///< or "name" or "order"
  double frames_per_second = kUsualFramesPerSecond;
  std::filesystem::path poses;  ///< TUM trajectory by stamp (number / frames_per_second); empty: none
};

std::optional<YAML::Node> findImagesNode(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kCalibrationFile;
  std::ifstream file(path);
  if (!file) return std::nullopt;
  try {
    const YAML::Node root = YAML::Load(file);
    return root.IsMap() && root["images"] ? std::optional<YAML::Node>(root["images"]) : std::nullopt;
  } catch (const YAML::Exception& error) {
    throw IoError(path, "a camera calibration in YAML", error.what());
  }
}

ImagesEntry readEntry(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kCalibrationFile;
  const YAML::Node node = *findImagesNode(folder);
  ImagesEntry entry;
  try {
    entry.color = node["color"].as<std::string>();
    entry.depth = node["depth"].as<std::string>();
    if (node["pair_by"]) entry.pair_by = node["pair_by"].as<std::string>();
    if (node["frames_per_second"]) entry.frames_per_second = node["frames_per_second"].as<double>();
    if (node["poses"]) entry.poses = node["poses"].as<std::string>();
  } catch (const YAML::Exception& error) {
    throw IoError(path, "images: {color: FOLDER, depth: FOLDER, pair_by: number|name|order, frames_per_second, poses}",
                  error.what());
  }
  if (entry.pair_by != "number" && entry.pair_by != "name" && entry.pair_by != "order") {
    throw IoError(path, "images: pair_by: number, name or order", entry.pair_by);
  }
  if (!(entry.frames_per_second > 0)) {
    throw IoError(path, "images: frames_per_second above 0", std::to_string(entry.frames_per_second));
  }
  for (const std::filesystem::path& images : {entry.color, entry.depth}) {
    if (!std::filesystem::is_directory(folder / images)) {
      throw IoError(path, "images: folders that exist", (folder / images).string());
    }
  }
  return entry;
}

std::map<std::int64_t, std::filesystem::path> inOrder(const std::map<std::string, std::filesystem::path>& by_name) {
  std::map<std::int64_t, std::filesystem::path> images;
  for (const auto& [name, path] : by_name) images.emplace(static_cast<std::int64_t>(images.size()), path);
  return images;
}

/// Numbers both lists by their common order of names, so that equal names have equal numbers.
void numberByName(const std::filesystem::path& folder, const ImagesEntry& entry, FrameList& list) {
  const auto color = imagesByName(folder / entry.color), depth = imagesByName(folder / entry.depth);
  std::map<std::int64_t, std::filesystem::path> color_by_number, depth_by_number;
  std::map<std::string, std::int64_t> numbers;
  for (const auto* images : {&color, &depth}) {
    for (const auto& [name, path] : *images) numbers[name] = 0;
  }
  std::int64_t next = 0;
  for (auto& [name, number] : numbers) number = next++;
  for (const auto& [name, path] : color) color_by_number[numbers[name]] = path;
  for (const auto& [name, path] : depth) depth_by_number[numbers[name]] = path;
  pairByNumber(folder, color_by_number, depth_by_number, list);
}

}  // namespace

bool looksLikePlainFolder(const std::filesystem::path& folder) {
  return findImagesNode(folder).has_value();
}

FrameList listPlainFolder(const std::filesystem::path& folder) {
  const ImagesEntry entry = readEntry(folder);
  FrameList list;
  list.description.kind = "plain folder";
  list.calibration = *findCalibrationFile(folder);
  if (!(list.calibration.depth_units_per_metre > 0)) {
    throw IoError(folder / kCalibrationFile, "depth: {units_per_metre: ...}", "none");
  }
  list.description.depth_scale_origin = list.calibration.origin;
  if (entry.pair_by == "name") {
    numberByName(folder, entry, list);
  } else if (entry.pair_by == "order") {
    pairByNumber(folder, inOrder(imagesByName(folder / entry.color)), inOrder(imagesByName(folder / entry.depth)),
                 list);
  } else {
    pairByNumber(folder, imagesByNumber(folder / entry.color), imagesByNumber(folder / entry.depth), list);
  }
  for (FrameFiles& files : list.frames) files.stamp_s *= kUsualFramesPerSecond / entry.frames_per_second;
  if (entry.poses.empty()) return list;
  const StampedPoses poses = StampedPoses::load(folder / entry.poses, list.description.remarks);
  for (FrameFiles& files : list.frames) files.T_WC = poses.nearest(files.stamp_s, 0.5 / entry.frames_per_second);
  remarkMissingPoses(list, entry.poses.string());
  return list;
}

}  // namespace saccade
