#include "sources/frame_list.hpp"

#include <algorithm>

#include "saccade/core/errors.hpp"
#include "saccade/sources/image_files.hpp"

namespace saccade {

std::optional<RgbdCalibration> findCalibrationFile(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / kCalibrationFile)) return std::nullopt;
  return loadCalibrationYaml(folder / kCalibrationFile);
}

PinholeCamera withSizeOf(PinholeCamera camera, const FrameList& list, std::filesystem::path FrameFiles::*part) {
  ImageReader reader;
  for (const FrameFiles& files : list.frames) {
    try {
      const ImageHeader header = reader.header(files.*part);
      camera.width = header.width;
      camera.height = header.height;
      return camera;
    } catch (const IoError&) {
      if (&files == &list.frames.back()) throw;
    }
  }
  return camera;
}

void settleDepthScale(FrameList& list, double units_per_metre, const std::string& origin) {
  if (list.calibration.depth_units_per_metre > 0) {
    list.description.depth_scale_origin = list.calibration.origin;
  } else {
    list.calibration.depth_units_per_metre = units_per_metre;
    list.description.depth_scale_origin = origin;
  }
}

void pairByNumber(const std::filesystem::path& folder, const std::map<std::int64_t, std::filesystem::path>& color,
                  const std::map<std::int64_t, std::filesystem::path>& depth, FrameList& list) {
  for (const auto& [number, path] : color) {
    const auto partner = depth.find(number);
    if (partner == depth.end()) continue;
    FrameFiles files;
    files.name = path.stem().string();
    files.stamp_s = static_cast<double>(number) / kUsualFramesPerSecond;
    files.color = path;
    files.depth = partner->second;
    list.frames.push_back(std::move(files));
  }
  list.description.dropped = static_cast<std::int64_t>(color.size() + depth.size() - 2 * list.frames.size());
  if (list.frames.empty()) {
    throw IoError(folder, "colour and depth images of the same numbers",
                  counted(static_cast<std::int64_t>(color.size()), "colour image") + ", " +
                      counted(static_cast<std::int64_t>(depth.size()), "depth image") + ", no number in both");
  }
}

void remarkMissingPoses(FrameList& list, const std::string& where) {
  const auto missing = std::count_if(list.frames.begin(), list.frames.end(),
                                     [](const FrameFiles& files) { return !files.T_WC.has_value(); });
  if (missing == 0 || missing == static_cast<std::ptrdiff_t>(list.frames.size())) return;
  list.description.remarks.push_back(counted(missing, "frame") + " without a usable pose in " + where);
}

}  // namespace saccade
