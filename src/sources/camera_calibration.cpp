#include "saccade/sources/camera_calibration.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include "saccade/core/errors.hpp"
#include "sources/pose_lines.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

double numberAt(const YAML::Node& node, const char* key, const std::filesystem::path& path) {
  if (!node[key]) throw IoError(path, std::string("the number ") + key, "none");
  const auto text = node[key].as<std::string>();
  const std::optional<double> number = parseNumber(text);
  if (!number || !std::isfinite(*number)) {
    throw IoError(path, std::string(key) + " to be a finite number", inQuotes(text));
  }
  return *number;
}

LensDistortion distortionAt(const YAML::Node& node, const std::filesystem::path& path) {
  if (!node["distortion"]) return {};
  const auto c = node["distortion"].as<std::vector<double>>();
  bool finite = true;
  for (const double value : c) finite = finite && std::isfinite(value);
  if ((c.size() != 4 && c.size() != 5) || !finite) {
    throw IoError(path, "4 or 5 finite distortion coefficients k1 k2 p1 p2 k3", std::to_string(c.size()));
  }
  return {c[0], c[1], c[2], c[3], c.size() == 5 ? c[4] : 0.0};
}

PinholeCamera requireCamera(const PinholeCamera& camera, bool with_size, const std::filesystem::path& path) {
  constexpr int kMaxSize = 32768;
  const bool good_size =
      !with_size || (camera.width > 0 && camera.height > 0 && camera.width < kMaxSize && camera.height < kMaxSize);
  if (good_size && camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.cx) && std::isfinite(camera.cy) &&
      std::isfinite(camera.fx) && std::isfinite(camera.fy)) {
    return camera;
  }
  std::ostringstream found;
  found << "fx " << camera.fx << ", fy " << camera.fy << ", cx " << camera.cx << ", cy " << camera.cy << ", "
        << camera.width << " x " << camera.height;
  throw IoError(path, "positive focal lengths and image sizes", found.str());
}

PinholeCamera cameraAt(const YAML::Node& node, const std::filesystem::path& path) {
  return requireCamera(
      {static_cast<int>(numberAt(node, "width", path)), static_cast<int>(numberAt(node, "height", path)),
       numberAt(node, "fx", path), numberAt(node, "fy", path), numberAt(node, "cx", path), numberAt(node, "cy", path)},
      true, path);
}

Pose transformAt(const YAML::Node& node, const std::filesystem::path& path) {
  const auto rows = node.as<std::vector<std::vector<double>>>();
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Constant(std::nan(""));
  for (std::size_t row = 0; row < rows.size() && row < 4; ++row) {
    for (std::size_t column = 0; column < rows[row].size() && column < 4; ++column) {
      matrix(static_cast<int>(row), static_cast<int>(column)) = rows[row][column];
    }
  }
  const std::optional<Pose> pose = rigidFromMatrix(matrix);
  if (!pose) throw IoError(path, "T_color_depth to be a rigid 4 x 4 matrix", "another matrix");
  return *pose;
}

double unitsOrUnknown(const YAML::Node& node, const char* key, const std::filesystem::path& path) {
  if (!node[key]) return 0.0;
  const double units = numberAt(node, key, path);
  if (!(units > 0)) throw IoError(path, std::string(key) + " above 0", std::to_string(units));
  return units;
}

RgbdCalibration parseCalibration(const YAML::Node& root, const std::filesystem::path& path) {
  if (!root.IsMap()) throw IoError(path, "a camera calibration", "no YAML map");
  const YAML::Node color = root["color"] ? root["color"] : root;
  RgbdCalibration calibration;
  calibration.origin = path.filename().string();
  calibration.color = cameraAt(color, path);
  calibration.color_distortion = distortionAt(color, path);
  calibration.depth_units_per_metre = unitsOrUnknown(root, "depth_units_per_metre", path);
  const YAML::Node depth = root["depth"];
  if (!depth) return calibration;
  if (depth["units_per_metre"]) calibration.depth_units_per_metre = unitsOrUnknown(depth, "units_per_metre", path);
  if (depth["invalid"]) {
    for (const int value : depth["invalid"].as<std::vector<int>>()) {
      if (value < 0 || value > 65535) throw IoError(path, "invalid depth values of 16 bits", std::to_string(value));
      calibration.depth_invalid.push_back(static_cast<std::uint16_t>(value));
    }
  }
  if (depth["along_ray"]) calibration.depth_along_ray = depth["along_ray"].as<bool>();
  if (root["T_color_depth"]) {
    calibration.depth =
        DepthCamera{cameraAt(depth, path), distortionAt(depth, path), transformAt(root["T_color_depth"], path)};
  }
  return calibration;
}

}  // namespace

RgbdCalibration loadCalibrationYaml(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw IoError(path, "a camera calibration", "nothing that can be read");
  std::stringstream text;
  text << file.rdbuf();
  return parseCalibrationYaml(text.str(), path);
}

RgbdCalibration parseCalibrationYaml(const std::string& yaml, const std::filesystem::path& path) {
  try {
    return parseCalibration(YAML::Load(yaml), path);
  } catch (const YAML::Exception& error) {
    throw IoError(path, "a camera calibration in YAML", error.what());
  }
}

std::string calibrationYaml(const RgbdCalibration& calibration) {
  const auto camera = [](const PinholeCamera& c, const LensDistortion& lens) {
    std::string text =
        fmt::format("width: {}, height: {}, fx: {}, fy: {}, cx: {}, cy: {}", c.width, c.height, c.fx, c.fy, c.cx, c.cy);
    if (!lens.isZero()) {
      text += fmt::format(", distortion: [{}, {}, {}, {}, {}]", lens.k1, lens.k2, lens.p1, lens.p2, lens.k3);
    }
    return text;
  };
  std::string yaml = "color: {" + camera(calibration.color, calibration.color_distortion) + "}\ndepth: {";
  std::vector<std::string> parts;
  if (calibration.depth) parts.push_back(camera(calibration.depth->camera, calibration.depth->distortion));
  if (calibration.depth_units_per_metre > 0) {
    parts.push_back(fmt::format("units_per_metre: {}", calibration.depth_units_per_metre));
  }
  if (!calibration.depth_invalid.empty()) {
    parts.push_back(fmt::format("invalid: [{}]", fmt::join(calibration.depth_invalid, ", ")));
  }
  if (calibration.depth_along_ray) parts.emplace_back("along_ray: true");
  yaml += fmt::format("{}}}\n", fmt::join(parts, ", "));
  if (!calibration.depth) return yaml;
  yaml += "T_color_depth:   # takes points of the depth camera to the colour camera, metres\n";
  const Eigen::Matrix4d T_CD = calibration.depth->T_CD.matrix();
  for (int i = 0; i < 4; ++i) {
    yaml += fmt::format("  - [{}, {}, {}, {}]\n", T_CD(i, 0), T_CD(i, 1), T_CD(i, 2), T_CD(i, 3));
  }
  return yaml;
}

RgbdCalibration loadCameraText(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    const std::vector<std::string_view> words = splitWords(line);
    if (words.empty() || words[0].front() == '#') continue;
    std::vector<double> n;
    for (const std::string_view word : words) n.push_back(parseNumber(word).value_or(std::nan("")));
    if (n.size() != 7 || !(n[6] > 0) || !(n[4] < 1e5) || !(n[5] < 1e5) || !(n[4] > 0) || !(n[5] > 0)) {
      throw IoError(path, "fx fy cx cy width height depth_units_per_metre", inQuotes(line));
    }
    RgbdCalibration calibration;
    calibration.color =
        requireCamera({static_cast<int>(n[4]), static_cast<int>(n[5]), n[0], n[1], n[2], n[3]}, true, path);
    calibration.depth_units_per_metre = n[6];
    calibration.origin = path.filename().string();
    return calibration;
  }
  throw IoError(path, "a line fx fy cx cy width height depth_units_per_metre", "no such line");
}

RgbdCalibration loadIntrinsicMatrix(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  const std::string content = text.str();
  std::vector<double> n;
  for (const std::string_view word : splitWords(content)) n.push_back(parseNumber(word).value_or(std::nan("")));
  if (n.size() != 9) throw IoError(path, "a 3 x 3 matrix", std::to_string(n.size()) + " words");
  RgbdCalibration calibration;
  calibration.color = requireCamera({0, 0, n[0], n[4], n[2], n[5]}, false, path);
  calibration.origin = path.filename().string();
  return calibration;
}

}  // namespace saccade
