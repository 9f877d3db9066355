#include "saccade/sources/recording.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include "saccade/core/errors.hpp"
#include "sources/recorders.hpp"

namespace saccade {
namespace {

constexpr double kRoundedUnitsPerMetre = 5000.0;
constexpr double kLargestRaw = 65534.0;  // 65535 is "no measurement"

bool isFolder(RecordingKind kind) {
  return kind == RecordingKind::kTumFolder || kind == RecordingKind::kSevenScenesFolder;
}

/// What the writers of folders make; nothing else is ever removed.
bool belongsToRecording(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  for (const char* own :
       {"rgb", "depth", "label", "rgb.txt", "depth.txt", "groundtruth.txt", "camera.yaml", "timestamps.txt"}) {
    if (name == own) return true;
  }
  return name.starts_with("frame-");
}

void prepareFolder(const std::filesystem::path& folder, WhenRecordingExists when) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(folder, "a folder that can be made", error.message());
  if (std::filesystem::is_empty(folder, error)) return;
  if (when == WhenRecordingExists::kRefuse) {
    throw IoError(folder, "no folder of that name yet, or an empty one (--force replaces a recording)",
                  "one that holds files");
  }
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (belongsToRecording(entry.path())) old.push_back(entry.path());
  }
  for (const std::filesystem::path& path : old) std::filesystem::remove_all(path, error);
}

}  // namespace

RecordingKind recordingKindOf(const std::filesystem::path& output, const std::string& folder_layout) {
  const std::string extension = output.extension().string();
  if (extension == ".rawlog") return RecordingKind::kRawlog;
  if (extension == ".bag") return RecordingKind::kBag;
  if (extension == ".oni") return RecordingKind::kOni;
  if (folder_layout == "tum") return RecordingKind::kTumFolder;
  if (folder_layout == "7scenes") return RecordingKind::kSevenScenesFolder;
  throw std::invalid_argument("record: expected the layout tum or 7scenes, found \"" + folder_layout + "\"");
}

std::unique_ptr<RecordingWriter> openRecording(const std::filesystem::path& output, RecordingKind kind,
                                               const SensorSource& source, WhenRecordingExists when) {
  if (isFolder(kind)) {
    prepareFolder(output, when);
  } else if (std::filesystem::exists(output) && when == WhenRecordingExists::kRefuse) {
    throw IoError(output, "no recording of that name yet (--force replaces it)", "one that exists");
  }
  const RgbdCalibration& calibration = source.calibration();
  switch (kind) {
    case RecordingKind::kTumFolder:
      return makeTumRecorder(output, calibration);
    case RecordingKind::kSevenScenesFolder:
      return makeSevenScenesRecorder(output, calibration);
    case RecordingKind::kRawlog:
      return makeRawlogRecorder(output, calibration);
    case RecordingKind::kBag:
      return makeBagRecorder(output, calibration);
    case RecordingKind::kOni:
      return makeOniRecorder(output, calibration);
  }
  throw std::invalid_argument("openRecording: an unknown kind");
}

RecordedDepth::RecordedDepth(const RgbdCalibration& calibration)
    : units_per_metre_(calibration.depth_units_per_metre > 1.0 ? calibration.depth_units_per_metre
                                                               : kRoundedUnitsPerMetre) {}

const cv::Mat1w& RecordedDepth::of(const SensorFrame& frame) {
  if (frame.depth_m.empty()) return frame.raw_depth;
  raw_.create(frame.depth_m.size());
  const auto metres_per_unit = static_cast<float>(1.0 / units_per_metre_);
  std::transform(frame.depth_m.begin(), frame.depth_m.end(), raw_.begin(), [&](float depth_m) {
    const double rounded = std::round(static_cast<double>(depth_m) * units_per_metre_);
    if (!(depth_m > 0.0f) || !std::isfinite(rounded)) return ushort{0};
    const auto raw = static_cast<ushort>(rounded <= kLargestRaw ? rounded : 0.0);
    // What was made of whole units comes out as it was.
    rounded_ |= static_cast<float>(raw) * metres_per_unit != depth_m;
    return raw;
  });
  return raw_;
}

PartialFile::PartialFile(std::filesystem::path path) : path_(std::move(path)), partial_(path_) {
  partial_ += ".partial";
}

void PartialFile::complete() {
  std::error_code error;
  std::filesystem::rename(partial_, path_, error);
  if (error) throw IoError(path_, "a recording that can be given its name", error.message());
}

}  // namespace saccade
