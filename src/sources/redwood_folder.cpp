#include <array>
#include <fstream>

#include <nlohmann/json.hpp>

#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"
#include "sources/image_names.hpp"
#include "sources/pose_lines.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

constexpr std::array kColorFolders = {"color", "rgb", "image"};
constexpr std::array kIntrinsicFiles = {"intrinsics.json", "intrinsic.json", "camera_intrinsic.json",
                                        "camera_intrinsics.json"};

std::optional<std::filesystem::path> findColorFolder(const std::filesystem::path& folder) {
  for (const char* name : kColorFolders) {
    if (std::filesystem::is_directory(folder / name)) return folder / name;
  }
  return std::nullopt;
}

std::optional<std::filesystem::path> findIntrinsics(const std::filesystem::path& folder) {
  for (const char* name : kIntrinsicFiles) {
    if (std::filesystem::exists(folder / name)) return folder / name;
  }
  return std::nullopt;
}

std::optional<std::filesystem::path> findTrajectory(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".log") return entry.path();
  }
  return std::nullopt;
}

/// Open3D's PinholeCameraIntrinsic: the matrix is a list of nine, column by column. Its recorder adds a `depth_scale`.
RgbdCalibration readIntrinsics(const std::filesystem::path& path) {
  std::ifstream file(path);
  RgbdCalibration calibration;
  calibration.origin = path.filename().string();
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    const auto matrix = json.at("intrinsic_matrix").get<std::vector<double>>();
    PinholeCamera& color = calibration.color;
    if (matrix.size() == 9) {
      color = {json.value("width", 0), json.value("height", 0), matrix[0], matrix[4], matrix[6], matrix[7]};
    }
    calibration.depth_units_per_metre = json.value("depth_scale", 0.0);
    if (!(color.fx > 0) || !(color.fy > 0) || color.width < 0 || color.height < 0 ||
        !(calibration.depth_units_per_metre >= 0)) {
      throw IoError(path, "width, height and an intrinsic_matrix of 9 numbers", json.dump());
    }
  } catch (const nlohmann::json::exception& error) {
    throw IoError(path, "a JSON with width, height and intrinsic_matrix", error.what());
  }
  return calibration;
}

/// Redwood's trajectory: blocks of `i i i+1` and a 4 x 4 matrix, camera to world, one for each frame in order.
void takePoses(const std::filesystem::path& path, FrameList& list) {
  std::ifstream file(path);
  std::vector<double> numbers;
  std::string line;
  while (std::getline(file, line)) {
    for (const std::string_view word : splitWords(line)) {
      const std::optional<double> number = parseNumber(word);
      if (!number) throw IoError(path, "blocks of three numbers and a 4 x 4 matrix", inQuotes(word));
      numbers.push_back(*number);
    }
  }
  constexpr std::size_t kHead = 3, kBlock = 19;
  if (numbers.size() % kBlock != 0) {
    throw IoError(path, "blocks of three numbers and a 4 x 4 matrix", std::to_string(numbers.size()) + " numbers");
  }
  for (std::size_t i = 0; i < list.frames.size() && (i + 1) * kBlock <= numbers.size(); ++i) {
    Eigen::Matrix4d matrix;
    for (std::size_t k = 0; k < 16; ++k) {
      matrix(static_cast<int>(k / 4), static_cast<int>(k % 4)) = numbers[i * kBlock + kHead + k];
    }
    list.frames[i].T_WC = rigidFromMatrix(matrix);
  }
  remarkMissingPoses(list, path.filename().string());
}

}  // namespace

bool looksLikeRedwood(const std::filesystem::path& folder) {
  const std::optional<std::filesystem::path> color = findColorFolder(folder);
  if (!color || !std::filesystem::is_directory(folder / "depth")) return false;
  // color/ and depth/ with a calibration of ours are labelled frames.
  return findIntrinsics(folder) || color->filename() != "color" ||
         (!std::filesystem::exists(folder / "camera.txt") && !std::filesystem::exists(folder / kCalibrationFile));
}

FrameList listRedwood(const std::filesystem::path& folder) {
  FrameList list;
  list.description.kind = "Redwood folder";
  pairByNumber(folder, imagesByNumber(*findColorFolder(folder)), imagesByNumber(folder / "depth"), list);
  if (std::optional<RgbdCalibration> own = findCalibrationFile(folder)) {
    list.calibration = *std::move(own);
  } else if (const auto intrinsics = findIntrinsics(folder)) {
    list.calibration = readIntrinsics(*intrinsics);
  } else {
    list.calibration.color = {0, 0, 525.0, 525.0, 319.5, 239.5};
    list.calibration.origin = "the usual PrimeSense camera (525 px), which Redwood takes too";
    list.description.remarks.emplace_back("neither camera.yaml nor intrinsics.json: intrinsics are " +
                                          list.calibration.origin);
  }
  settleDepthScale(list, 1000.0, "Redwood depth is in millimetres");
  if (const auto trajectory = findTrajectory(folder)) takePoses(*trajectory, list);
  return list;
}

}  // namespace saccade
