#include <cmath>
#include <fstream>
#include <sstream>

#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"
#include "sources/image_names.hpp"
#include "sources/pose_lines.hpp"
#include "sources/range_image_text.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

constexpr const char* kAssociations = "associations.txt";

/// ICL-NUIM's camera has y up and its world is left-handed ("fy = -480"): mirroring both in y gives C and W.
Pose mirroredInY(const Pose& T) {
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  Pose mirrored = Pose::Identity();
  mirrored.linear() = mirror * T.linear() * mirror;
  mirrored.translation() = mirror * T.translation();
  return mirrored;
}

std::optional<std::filesystem::path> findTrajectory(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".freiburg") return entry.path();
  }
  return std::nullopt;
}

bool isPovRay(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != kRangeImageTextExtension) continue;
    if (std::filesystem::exists(std::filesystem::path(entry.path()).replace_extension(".png"))) return true;
  }
  return false;
}

/// `cam_NAME = [x, y, z]';` of a POV-Ray camera file.
std::optional<Eigen::Vector3d> vectorOf(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(name);
  const std::size_t open = at == std::string::npos ? at : text.find('[', at);
  const std::size_t close = open == std::string::npos ? open : text.find(']', open);
  if (close == std::string::npos) return std::nullopt;
  const std::vector<std::string_view> words = splitWords(std::string_view(text).substr(open + 1, close - open - 1));
  if (words.size() != 3) return std::nullopt;
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) vector(i) = parseNumber(words[static_cast<std::size_t>(i)]).value_or(std::nan(""));
  return vector.allFinite() ? std::optional(vector) : std::nullopt;
}

/// Pose of a POV-Ray camera, from its position, direction and up vector.
std::optional<Pose> readPovRayPose(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream content;
  content << file.rdbuf();
  const std::string text = content.str();
  const auto position = vectorOf(text, "cam_pos"), direction = vectorOf(text, "cam_dir"), up = vectorOf(text, "cam_up");
  if (!position || !direction || !up) return std::nullopt;
  const Eigen::Vector3d z = direction->normalized(), x = up->cross(z).normalized();
  Pose pose = Pose::Identity();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = *position;
  if (!pose.matrix().allFinite()) return std::nullopt;
  return mirroredInY(pose);
}

void listPovRay(const std::filesystem::path& folder, FrameList& list) {
  std::map<std::int64_t, std::filesystem::path> color, range;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != kRangeImageTextExtension) continue;
    const std::optional<double> last = trailingNumber(entry.path().stem().string());
    if (!last) continue;
    const auto number = static_cast<std::int64_t>(*last);
    range[number] = entry.path();
    const std::filesystem::path image = std::filesystem::path(entry.path()).replace_extension(".png");
    if (std::filesystem::exists(image)) color[number] = image;
  }
  pairByNumber(folder, color, range, list);
  for (FrameFiles& files : list.frames) {
    files.T_WC = readPovRayPose(std::filesystem::path(files.color).replace_extension(".txt"));
  }
  list.calibration.depth_along_ray = true;
  settleDepthScale(list, 1.0, "POV-Ray's distances are in metres");
  remarkMissingPoses(list, "its camera file");
}

/// Lines `number depth/N.png number rgb/N.png`, either way round.
void listAssociations(const std::filesystem::path& folder, FrameList& list) {
  std::ifstream file(folder / kAssociations);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string_view> words = splitWords(line);
    if (words.empty() || words[0].front() == '#') continue;
    const std::optional<double> stamp = parseNumber(words[0]);
    if (words.size() != 4 || !stamp || !std::isfinite(*stamp)) {
      throw IoError(folder / kAssociations, "\"N depth/N.png N rgb/N.png\" in line " + std::to_string(number),
                    inQuotes(line));
    }
    const bool depth_first = words[1].find("depth") != std::string_view::npos;
    FrameFiles files;
    files.color = folder / std::filesystem::path(words[depth_first ? 3 : 1]);
    files.depth = folder / std::filesystem::path(words[depth_first ? 1 : 3]);
    files.name = files.color.stem().string();
    files.stamp_s = *stamp / kUsualFramesPerSecond;
    list.frames.push_back(std::move(files));
  }
  if (list.frames.empty()) throw IoError(folder / kAssociations, "pairs of images", "an empty list");
  settleDepthScale(list, 5000.0, "ICL-NUIM's PNG depth has 5000 units a metre");

  const std::optional<std::filesystem::path> trajectory = findTrajectory(folder);
  if (!trajectory) return;
  std::map<double, Pose> poses;
  for (const PoseLine& pose : readPoseLines(*trajectory)) {
    if (pose.stamp_s && pose.pose) poses[*pose.stamp_s] = *pose.pose;
  }
  for (FrameFiles& files : list.frames) {
    const auto found = poses.find(std::round(files.stamp_s * kUsualFramesPerSecond));
    if (found != poses.end()) files.T_WC = mirroredInY(found->second);
  }
  remarkMissingPoses(list, trajectory->filename().string());
}

}  // namespace

bool looksLikeIclNuim(const std::filesystem::path& folder) {
  return (std::filesystem::exists(folder / kAssociations) && std::filesystem::is_directory(folder / "rgb") &&
          std::filesystem::is_directory(folder / "depth") && findTrajectory(folder)) ||
         isPovRay(folder);
}

FrameList listIclNuim(const std::filesystem::path& folder) {
  FrameList list;
  list.description.kind = "ICL-NUIM folder";
  if (std::optional<RgbdCalibration> own = findCalibrationFile(folder)) {
    list.calibration = *std::move(own);
  } else {
    list.calibration.color = {640, 480, 481.2, 480.0, 319.5, 239.5};
    list.calibration.origin = "ICL-NUIM's calibration (its fy of -480 by turning y over)";
  }
  if (isPovRay(folder)) {
    listPovRay(folder, list);
  } else {
    listAssociations(folder, list);
  }
  return list;
}

}  // namespace saccade
