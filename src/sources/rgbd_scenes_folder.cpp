#include <cmath>
#include <fstream>

#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"
#include "sources/image_names.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

enum class Version { kOne, kTwo };

struct Images {
  Version version = Version::kOne;
  std::map<std::int64_t, std::filesystem::path> color, depth;
};

Images findImages(const std::filesystem::path& folder) {
  Images images;
  std::map<std::int64_t, std::filesystem::path> others;
  for (const auto& [name, path] : imagesByName(folder)) {
    const auto stemBefore = [&file_name = name](const char* ending) {
      return file_name.substr(0, file_name.size() - std::string(ending).size());
    };
    if (name.ends_with("-color")) {
      images.version = Version::kTwo;
      if (const auto number = trailingNumber(stemBefore("-color")))
        images.color[static_cast<std::int64_t>(*number)] = path;
    } else if (name.ends_with("-depth")) {
      if (const auto number = trailingNumber(stemBefore("-depth")))
        images.depth[static_cast<std::int64_t>(*number)] = path;
    } else if (name.ends_with("_depth")) {
      if (const auto number = trailingNumber(stemBefore("_depth")))
        images.depth[static_cast<std::int64_t>(*number)] = path;
    } else if (const auto number = trailingNumber(name)) {
      others[static_cast<std::int64_t>(*number)] = path;
    }
  }
  if (images.version == Version::kOne) images.color = std::move(others);
  return images;
}

/// `NN.pose` of v2, lines `qw qx qy qz x y z` in the order of the frames, camera to world: in the folder, beside it, or
/// in the release's `pc/`.
std::optional<std::filesystem::path> findPoses(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".pose") return entry.path();
  }
  const std::filesystem::path absolute = std::filesystem::absolute(folder / "").lexically_normal().parent_path();
  const std::string name = absolute.filename().string();
  const std::string file = name.substr(name.find_last_of('_') + 1) + ".pose";
  for (const std::filesystem::path& place :
       {absolute.parent_path() / file, absolute.parent_path().parent_path() / "pc" / file}) {
    if (std::filesystem::exists(place)) return place;
  }
  return std::nullopt;
}

void takePoses(const std::filesystem::path& path, FrameList& list) {
  std::ifstream file(path);
  std::string line;
  for (std::size_t i = 0; i < list.frames.size() && std::getline(file, line);) {
    const std::vector<std::string_view> words = splitWords(line);
    if (words.empty()) continue;
    std::vector<double> n;
    for (const std::string_view word : words) n.push_back(parseNumber(word).value_or(std::nan("")));
    FrameFiles& files = list.frames[i++];
    if (n.size() != 7) continue;
    const Eigen::Quaterniond rotation(n[0], n[1], n[2], n[3]);
    const Eigen::Vector3d position(n[4], n[5], n[6]);
    if (!(std::abs(rotation.norm() - 1.0) < 0.02) || !position.allFinite()) continue;
    files.T_WC = Pose::Identity();
    files.T_WC->linear() = rotation.normalized().toRotationMatrix();
    files.T_WC->translation() = position;
  }
  remarkMissingPoses(list, path.filename().string());
}

}  // namespace

bool looksLikeRgbdScenes(const std::filesystem::path& folder) {
  const Images images = findImages(folder);
  return !images.color.empty() && !images.depth.empty();
}

FrameList listRgbdScenes(const std::filesystem::path& folder) {
  const Images images = findImages(folder);
  FrameList list;
  list.description.kind = "RGB-D Scenes folder";
  pairByNumber(folder, images.color, images.depth, list);
  if (std::optional<RgbdCalibration> own = findCalibrationFile(folder)) {
    list.calibration = *std::move(own);
  } else {
    list.calibration.color = {640, 480, 570.3, 570.3, 320.0, 240.0};
    list.calibration.origin = "the calibration published with RGB-D Scenes";
  }
  if (images.version == Version::kOne) {
    settleDepthScale(list, 1000.0, "depth of RGB-D Scenes v1 is in millimetres");
  } else {
    settleDepthScale(list, 10000.0, "depth of RGB-D Scenes v2 is in tenths of a millimetre");
    if (const auto poses = findPoses(folder)) takePoses(*poses, list);
  }
  return list;
}

}  // namespace saccade
