#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"
#include "sources/image_names.hpp"
#include "sources/pose_lines.hpp"

namespace saccade {
namespace {

PinholeCamera readIntrinsics(const std::filesystem::path& path) {
  const std::optional<Eigen::Matrix4d> matrix = readMatrix4(path);
  if (!matrix || !((*matrix)(0, 0) > 0) || !((*matrix)(1, 1) > 0)) {
    throw IoError(path, "a 4 x 4 matrix of intrinsics", "none that can be used");
  }
  return {0, 0, (*matrix)(0, 0), (*matrix)(1, 1), (*matrix)(0, 2), (*matrix)(1, 2)};
}

Pose readExtrinsics(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return Pose::Identity();
  const std::optional<Pose> pose = readPoseMatrix(path);
  if (!pose) throw IoError(path, "a rigid 4 x 4 matrix", "another matrix");
  return *pose;
}

/// ScanNet's two cameras share their place, but not their lens and size: depth is rendered into colour.
RgbdCalibration readCalibration(const std::filesystem::path& folder, const FrameList& list) {
  const std::filesystem::path intrinsic = folder / "intrinsic";
  RgbdCalibration calibration;
  calibration.origin = "intrinsic/intrinsic_color.txt";
  calibration.color = withSizeOf(readIntrinsics(intrinsic / "intrinsic_color.txt"), list, &FrameFiles::color);
  if (std::filesystem::exists(intrinsic / "intrinsic_depth.txt")) {
    DepthCamera depth;
    depth.camera = withSizeOf(readIntrinsics(intrinsic / "intrinsic_depth.txt"), list, &FrameFiles::depth);
    depth.T_CD =
        readExtrinsics(intrinsic / "extrinsic_color.txt").inverse() * readExtrinsics(intrinsic / "extrinsic_depth.txt");
    if (depth.camera != calibration.color) calibration.depth = depth;
  }
  return calibration;
}

}  // namespace

bool looksLikeScanNet(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder / "color") && std::filesystem::is_directory(folder / "depth") &&
         std::filesystem::exists(folder / "intrinsic" / "intrinsic_color.txt");
}

FrameList listScanNet(const std::filesystem::path& folder) {
  FrameList list;
  list.description.kind = "ScanNet folder";
  pairByNumber(folder, imagesByNumber(folder / "color"), imagesByNumber(folder / "depth"), list);
  std::optional<RgbdCalibration> own = findCalibrationFile(folder);
  list.calibration = own ? *std::move(own) : readCalibration(folder, list);
  settleDepthScale(list, 1000.0, "ScanNet depth is in millimetres");
  for (FrameFiles& files : list.frames) {
    files.T_WC = readPoseMatrix(folder / "pose" / (files.name + ".txt"));
  }
  remarkMissingPoses(list, "pose/");
  return list;
}

}  // namespace saccade
