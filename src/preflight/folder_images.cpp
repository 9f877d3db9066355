#include "preflight/folder_images.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "saccade/sources/image_files.hpp"

namespace saccade {
namespace {

// Heads of so many frames, spread over the sequence; whether a file is there is asked of all.
constexpr std::size_t kReadFrames = 200;
constexpr double kMost = 0.5;  // share of the frames from which on exploring is given up

struct Tally {
  std::int64_t checked = 0;
  std::int64_t unreadable = 0, swapped = 0, depth_8_bit = 0, color_turned = 0, color_size = 0, depth_size = 0;
  std::string unreadable_example;
  ImageHeader color, depth;  ///< of the last odd frame
};

bool isMeasurement(const ImageHeader& header) {
  return header.channels == 1 && header.bits_per_channel == 16;
}

bool isOfSize(const ImageHeader& header, const PinholeCamera& camera) {
  return camera.width == 0 || (header.width == camera.width && header.height == camera.height);
}

bool isTurned(const ImageHeader& header, const PinholeCamera& camera) {
  return header.width == camera.height && header.height == camera.width && camera.width != camera.height;
}

/// The camera that the depth image of a frame must fit: its own, or colour's, which the image itself may have to tell.
PinholeCamera depthCameraOf(const RgbdCalibration& calibration, const ImageHeader& color) {
  if (calibration.depth) return calibration.depth->camera;
  PinholeCamera camera = calibration.color;
  camera.width = color.width;
  camera.height = color.height;
  return camera;
}

/// What is odd about the heads of one frame's images: the number to be raised; none: nothing.
std::int64_t* oddness(const ImageHeader& color, const ImageHeader* depth, const RgbdCalibration& calibration,
                      Tally& tally) {
  if (depth != nullptr && !isMeasurement(*depth)) return isMeasurement(color) ? &tally.swapped : &tally.depth_8_bit;
  if (isTurned(color, calibration.color)) return &tally.color_turned;
  if (!isOfSize(color, calibration.color)) return &tally.color_size;
  if (depth != nullptr && !isOfSize(*depth, depthCameraOf(calibration, color))) return &tally.depth_size;
  return nullptr;
}

void examine(const FrameFiles& files, const RgbdCalibration& calibration, ImageReader& reader, Tally& tally) {
  ++tally.checked;
  try {
    const ImageHeader color = reader.header(files.color);
    const ImageHeader depth = files.depth.empty() ? ImageHeader{} : reader.header(files.depth);
    std::int64_t* const odd = oddness(color, files.depth.empty() ? nullptr : &depth, calibration, tally);
    if (odd == nullptr) return;
    ++*odd;
    tally.color = color;
    tally.depth = depth;
  } catch (const IoError& error) {
    ++tally.unreadable;
    if (tally.unreadable_example.empty()) tally.unreadable_example = error.what();
  }
}

/// Counts the files that are not there, and leaves their frames out.
std::vector<const FrameFiles*> presentFrames(const FrameList& list, std::vector<PreflightFinding>& findings) {
  std::vector<const FrameFiles*> present;
  std::filesystem::path missing;
  for (const FrameFiles& files : list.frames) {
    const bool color = std::filesystem::exists(files.color);
    const bool depth = files.depth.empty() || std::filesystem::exists(files.depth);
    if (color && depth) {
      present.push_back(&files);
    } else if (missing.empty()) {
      missing = color ? files.depth : files.color;
    }
  }
  const std::size_t absent = list.frames.size() - present.size();
  if (absent == 0) return present;
  const double share = static_cast<double>(absent) / static_cast<double>(list.frames.size());
  findings.push_back(
      {share >= kMost ? FindingSeverity::kFault : FindingSeverity::kWarning, "missing-images",
       fmt::format("{} of {} frames lack a file, the first is {}", absent, list.frames.size(), missing.string())});
  return present;
}

}  // namespace

void checkFolderImages(const FrameList& list, std::vector<PreflightFinding>& findings) {
  const std::vector<const FrameFiles*> present = presentFrames(list, findings);
  Tally tally;
  ImageReader reader;
  const std::size_t read = std::min(kReadFrames, present.size());
  for (std::size_t i = 0; i < read; ++i) examine(*present[i * present.size() / read], list.calibration, reader, tally);

  const auto add = [&](std::int64_t count, const char* code, const std::string& text) {
    if (count == 0) return;
    const double share = static_cast<double>(count) / static_cast<double>(tally.checked);
    findings.push_back({share >= kMost ? FindingSeverity::kFault : FindingSeverity::kWarning, code,
                        fmt::format("in {} of {} frames looked at, {}", count, tally.checked, text)});
  };
  const PinholeCamera& camera = list.calibration.color;
  const auto size = [](const ImageHeader& header) { return fmt::format("{} x {}", header.width, header.height); };
  add(tally.swapped, "swapped-lists",
      "colour has one channel of 16 bits and depth has not: the two lists or folders are in each other's place");
  add(tally.depth_8_bit, "depth-8-bit",
      fmt::format("depth has {} channel{} of {} bits: that is a picture of depth, not a measurement. Export it again "
                  "as 16-bit PNG",
                  tally.depth.channels, tally.depth.channels == 1 ? "" : "s", tally.depth.bits_per_channel));
  add(tally.color_turned, "rotated-images",
      fmt::format("colour is {}, the intrinsics ({}) are for {} x {}: images were turned by 90 degrees after "
                  "calibration. Turn them back, or turn the intrinsics too",
                  size(tally.color), list.calibration.origin, camera.width, camera.height));
  add(tally.color_size, "wrong-size",
      fmt::format("colour is {}, the intrinsics ({}) are for {} x {}: scale them alike, or take the camera's own",
                  size(tally.color), list.calibration.origin, camera.width, camera.height));
  add(tally.depth_size, "wrong-size",
      fmt::format("depth is {} and colour {}: depth that is not registered needs a camera.yaml with both cameras",
                  size(tally.depth), size(tally.color)));
  add(tally.unreadable, "unreadable-images", "an image cannot be read: " + tally.unreadable_example);
}

}  // namespace saccade
