
#include "saccade/core/errors.hpp"
#include "saccade/sources/stamped_poses.hpp"
#include "sources/association.hpp"
#include "sources/frame_list.hpp"
#include "sources/stamped_files.hpp"

namespace saccade {
namespace {

constexpr double kMaxStampDifference_s = kSamePairStamps_s;

bool mentions(const std::string& text, const std::string& first, const std::string& second) {
  return text.find(first) != std::string::npos || text.find(second) != std::string::npos;
}

RgbdCalibration findCalibration(const std::filesystem::path& folder, std::vector<std::string>& remarks) {
  if (std::filesystem::exists(folder / "intrinsics.yaml")) return loadCalibrationYaml(folder / "intrinsics.yaml");
  if (std::filesystem::exists(folder / kCalibrationFile)) return loadCalibrationYaml(folder / kCalibrationFile);
  if (std::filesystem::exists(folder / "camera.txt")) return loadCameraText(folder / "camera.txt");
  const std::string name = std::filesystem::absolute(folder).lexically_normal().string();
  RgbdCalibration usual;
  if (mentions(name, "freiburg1", "fr1")) {
    usual.color = {640, 480, 517.3, 516.5, 318.6, 255.3};
    usual.origin = "TUM's calibration of freiburg1, by the folder's name";
  } else if (mentions(name, "freiburg2", "fr2")) {
    usual.color = {640, 480, 520.9, 521.0, 325.1, 249.7};
    usual.origin = "TUM's calibration of freiburg2, by the folder's name";
  } else if (mentions(name, "freiburg3", "fr3")) {
    usual.color = {640, 480, 535.4, 539.2, 320.1, 247.6};
    usual.origin = "TUM's calibration of freiburg3, by the folder's name";
  } else {
    usual.color = {640, 480, 525.0, 525.0, 319.5, 239.5};
    usual.origin = "the usual Kinect (525 px), for want of anything better";
  }
  remarks.push_back("neither intrinsics.yaml nor camera.txt: intrinsics are " + usual.origin);
  return usual;
}

}  // namespace

bool looksLikeTum(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "rgb.txt") && std::filesystem::exists(folder / "depth.txt");
}

FrameList listTum(const std::filesystem::path& folder) {
  const std::vector<StampedFile> color = readStampedFiles(folder / "rgb.txt");
  const std::vector<StampedFile> depth = readStampedFiles(folder / "depth.txt");
  const std::vector<StampPair> pairs = associate(stampsOf(color), stampsOf(depth), kMaxStampDifference_s);
  if (pairs.empty()) {
    throw IoError(folder, "stamps of rgb.txt and depth.txt within 20 ms of each other",
                  "none among " + counted(static_cast<std::int64_t>(color.size()), "colour image") + " and " +
                      counted(static_cast<std::int64_t>(depth.size()), "depth image"));
  }

  FrameList list;
  list.description.kind = "TUM folder";
  list.calibration = findCalibration(folder, list.description.remarks);
  if (list.calibration.depth_units_per_metre > 0) {
    list.description.depth_scale_origin = list.calibration.origin;
  } else {
    list.calibration.depth_units_per_metre = 5000.0;
    list.description.depth_scale_origin = "TUM depth has 5000 units a metre";
  }
  list.description.dropped = static_cast<std::int64_t>(color.size() + depth.size() - 2 * pairs.size());

  const StampedPoses truth = std::filesystem::exists(folder / "groundtruth.txt")
                                 ? StampedPoses::load(folder / "groundtruth.txt", list.description.remarks)
                                 : StampedPoses();
  std::int64_t without_pose = 0;
  for (const StampPair& pair : pairs) {
    FrameFiles files;
    files.color = color[pair.first].path;
    files.depth = depth[pair.second].path;
    files.name = files.color.stem().string();
    files.stamp_s = color[pair.first].stamp_s;
    files.T_WC = truth.interpolate(files.stamp_s, kMaxStampDifference_s);
    without_pose += files.T_WC ? 0 : 1;
    list.frames.push_back(std::move(files));
  }
  if (!truth.empty() && without_pose > 0) {
    list.description.remarks.push_back(counted(without_pose, "frame") + " without a ground-truth pose within 20 ms");
  }
  return list;
}

}  // namespace saccade
