#include <cmath>
#include <fstream>

#include <opencv2/core/persistence.hpp>

#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"
#include "sources/image_names.hpp"
#include "sources/pose_lines.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

// Exports are named by stamp or by node id; stamps are Unix times, ids far smaller.
constexpr double kSmallestStamp_s = 1e8;

/// What all folders and files of one export begin with: "NAME_", or nothing.
std::optional<std::string> findPrefix(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || !name.ends_with("calib")) continue;
    std::string prefix = name.substr(0, name.size() - 5);
    if (std::filesystem::is_directory(folder / (prefix + "rgb")) &&
        std::filesystem::is_directory(folder / (prefix + "depth"))) {
      return prefix;
    }
  }
  return std::nullopt;
}

struct CalibFile {
  RgbdCalibration calibration;
  Pose T_BC = Pose::Identity();  ///< the camera on the robot's base ("local_transform")
};

/// A matrix written as `rows`, `cols` and `data`, with or without OpenCV's type tag; empty if it has another size.
std::vector<double> matrixOf(const cv::FileNode& node, int rows, int columns) {
  std::vector<double> data;
  if (node.empty() || !node.isMap() || static_cast<int>(node["rows"]) != rows ||
      static_cast<int>(node["cols"]) != columns) {
    return data;
  }
  node["data"] >> data;
  if (data.size() != static_cast<std::size_t>(rows * columns)) data.clear();
  return data;
}

CalibFile parseCalib(const cv::FileStorage& file) {
  CalibFile calib;
  if (const std::vector<double> k = matrixOf(file["camera_matrix"], 3, 3); !k.empty()) {
    calib.calibration.color = {
        static_cast<int>(file["image_width"]), static_cast<int>(file["image_height"]), k[0], k[4], k[2], k[5]};
  }
  for (const int count : {4, 5}) {
    const std::vector<double> d = matrixOf(file["distortion_coefficients"], 1, count);
    if (!d.empty()) calib.calibration.color_distortion = {d[0], d[1], d[2], d[3], count == 5 ? d[4] : 0.0};
  }
  if (const std::vector<double> local = matrixOf(file["local_transform"], 3, 4); !local.empty()) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 12; ++i) T(i / 4, i % 4) = local[static_cast<std::size_t>(i)];
    calib.T_BC = rigidFromMatrix(T).value_or(Pose::Identity());
  }
  return calib;
}

/// One camera model in OpenCV's YAML.
CalibFile readCalib(const std::filesystem::path& path) {
  const std::string expected = "a camera model with image_width, image_height and a 3 x 3 camera_matrix";
  CalibFile calib;
  try {
    const cv::FileStorage file(path.string(), cv::FileStorage::READ);
    if (!file.isOpened()) throw IoError(path, expected, "nothing that can be read");
    calib = parseCalib(file);
  } catch (const cv::Exception& error) {
    throw IoError(path, expected, error.err);
  }
  const PinholeCamera& color = calib.calibration.color;
  if (color.width <= 0 || color.height <= 0 || !(color.fx > 0) || !(color.fy > 0)) {
    throw IoError(path, expected, "no usable numbers");
  }
  calib.calibration.origin = (path.parent_path().filename() / path.filename()).string();
  return calib;
}

/// `camera_poses.txt` are poses of the camera, `poses.txt` of the robot's base; lines may end with the node's id.
void takePoses(const std::filesystem::path& folder, const std::string& prefix, const Pose& T_BC, FrameList& list) {
  const std::filesystem::path of_camera = folder / (prefix + "camera_poses.txt");
  const bool by_camera = std::filesystem::exists(of_camera);
  const std::filesystem::path path = by_camera ? of_camera : folder / (prefix + "poses.txt");
  if (!std::filesystem::exists(path)) return;
  std::map<double, Pose> by_stamp, by_id;
  for (const PoseLine& line : readPoseLines(path, 9)) {
    if (!line.pose) continue;
    const Pose T_WC = by_camera ? *line.pose : *line.pose * T_BC;
    if (line.stamp_s) by_stamp[*line.stamp_s] = T_WC;
    if (line.last) by_id[*line.last] = T_WC;
  }
  constexpr double kSameStamp_s = 1e-4;  // names carry six digits, lists five or six
  for (FrameFiles& files : list.frames) {
    const std::optional<double> key = parseNumber(files.name);
    if (!key) continue;
    if (const auto found = by_id.find(*key); found != by_id.end()) {
      files.T_WC = found->second;
    } else if (const auto near = by_stamp.lower_bound(*key - kSameStamp_s);
               near != by_stamp.end() && near->first <= *key + kSameStamp_s) {
      files.T_WC = near->second;
    }
  }
  remarkMissingPoses(list, path.filename().string());
}

}  // namespace

bool looksLikeRtabMap(const std::filesystem::path& folder) {
  return findPrefix(folder).has_value();
}

FrameList listRtabMap(const std::filesystem::path& folder) {
  const std::string prefix = *findPrefix(folder);
  FrameList list;
  list.description.kind = "RTAB-Map export";
  const auto color = imagesByName(folder / (prefix + "rgb")), depth = imagesByName(folder / (prefix + "depth"));
  std::map<double, FrameFiles> by_key;
  for (const auto& [name, path] : color) {
    const auto partner = depth.find(name);
    const std::optional<double> key = parseNumber(name);
    if (partner == depth.end() || !key || !std::isfinite(*key)) continue;
    FrameFiles files;
    files.name = name;
    files.stamp_s = *key >= kSmallestStamp_s ? *key : *key / kUsualFramesPerSecond;
    files.color = path;
    files.depth = partner->second;
    by_key[*key] = std::move(files);
  }
  for (auto& [key, files] : by_key) list.frames.push_back(std::move(files));
  list.description.dropped = static_cast<std::int64_t>(color.size() + depth.size() - 2 * list.frames.size());
  if (list.frames.empty()) {
    throw IoError(folder, "images of the same stamps or ids in " + prefix + "rgb/ and " + prefix + "depth/", "none");
  }
  const CalibFile calib = readCalib(folder / (prefix + "calib") / (list.frames.front().name + ".yaml"));
  std::optional<RgbdCalibration> own = findCalibrationFile(folder);
  list.calibration = own ? *std::move(own) : calib.calibration;
  settleDepthScale(list, 1000.0, "RTAB-Map depth is in millimetres");
  takePoses(folder, prefix, calib.T_BC, list);
  return list;
}

}  // namespace saccade
