#include <algorithm>
#include <map>

#include "saccade/core/errors.hpp"
#include "saccade/sources/label_folder.hpp"
#include "sources/frame_list.hpp"
#include "sources/image_names.hpp"
#include "sources/pose_lines.hpp"

namespace saccade {
namespace {

/// Finds the poses of frames in a list that is keyed by name, by number, or by nothing but its order.
void takePoses(const std::filesystem::path& path, FrameList& list) {
  const std::vector<PoseLine> lines = readPoseLines(path);
  std::map<std::string, const PoseLine*> by_name;
  std::map<double, const PoseLine*> by_number;
  for (const PoseLine& line : lines) {
    by_name[line.key] = &line;
    if (line.stamp_s) by_number[*line.stamp_s] = &line;
  }
  const auto find = [&](const FrameFiles& files) -> const PoseLine* {
    if (const auto found = by_name.find(files.name); found != by_name.end()) return found->second;
    const std::optional<double> number = trailingNumber(files.name);
    if (!number) return nullptr;
    const auto found = by_number.find(*number);
    return found == by_number.end() ? nullptr : found->second;
  };

  std::size_t keyed = 0;
  for (const FrameFiles& files : list.frames) keyed += find(files) != nullptr ? 1 : 0;
  const bool by_order = keyed == 0 && lines.size() == list.frames.size();
  std::size_t with_pose = 0;
  for (std::size_t i = 0; i < list.frames.size(); ++i) {
    const PoseLine* line = by_order ? &lines[i] : find(list.frames[i]);
    if (line != nullptr) list.frames[i].T_WC = line->pose;
    with_pose += list.frames[i].T_WC ? 1 : 0;
  }
  if (by_order) list.description.remarks.emplace_back("poses are taken in the order of groundtruth.txt");
  if (with_pose < list.frames.size()) {
    list.description.remarks.push_back(counted(static_cast<std::int64_t>(list.frames.size() - with_pose), "frame") +
                                       " without a usable pose in " + path.filename().string());
  }
}

}  // namespace

bool looksLikeLabelledFrames(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder / "color") && std::filesystem::is_directory(folder / "depth");
}

FrameList listLabelledFrames(const std::filesystem::path& folder) {
  const std::map<std::string, std::filesystem::path> color = imagesByName(folder / "color");
  const std::map<std::string, std::filesystem::path> depth = imagesByName(folder / "depth");

  FrameList list;
  list.description.kind = "labelled frames";
  list.calibration = std::filesystem::exists(folder / kCalibrationFile) ? loadCalibrationYaml(folder / kCalibrationFile)
                                                                        : loadCameraText(folder / "camera.txt");
  if (!(list.calibration.depth_units_per_metre > 0)) {
    throw IoError(folder / list.calibration.origin, "the number of depth units per metre", "none");
  }
  list.description.depth_scale_origin = list.calibration.origin;

  std::optional<LabelFolder> labels;
  if (std::filesystem::is_directory(folder / "label")) labels.emplace(folder / "label");
  if (labels) list.description.ignore_from = labels->ignoreFrom();

  for (const auto& [name, path] : color) {
    const auto partner = depth.find(name);
    if (partner == depth.end()) continue;
    FrameFiles files;
    files.name = name;
    // No stamps in this layout: the place in the sequence stands for the time.
    files.stamp_s = static_cast<double>(list.frames.size()) / kUsualFramesPerSecond;
    files.color = path;
    files.depth = partner->second;
    if (labels) files.label = labels->find(name);
    list.frames.push_back(std::move(files));
  }
  list.description.dropped = static_cast<std::int64_t>(color.size() + depth.size() - 2 * list.frames.size());
  if (list.frames.empty()) {
    throw IoError(folder, "images of the same names in color/ and depth/",
                  counted(static_cast<std::int64_t>(color.size()), "colour image") + ", " +
                      counted(static_cast<std::int64_t>(depth.size()), "depth image") + ", no name in both");
  }
  if (std::filesystem::exists(folder / "groundtruth.txt")) takePoses(folder / "groundtruth.txt", list);
  return list;
}

}  // namespace saccade
