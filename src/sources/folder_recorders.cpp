#include <algorithm>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "saccade/core/errors.hpp"
#include "sources/recorders.hpp"

namespace saccade {
namespace {

void requireWritten(std::ofstream& file, const std::filesystem::path& path) {
  file.flush();
  if (!file) throw IoError(path, "room for the file", "it could not be written in full");
}

/// Writes the parts of a folder; what is not whole does not stay.
class FolderFiles {
 public:
  explicit FolderFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void makeFolder(const char* name) const {
    std::error_code error;
    std::filesystem::create_directories(folder_ / name, error);
    if (error) throw IoError(folder_ / name, "a folder that can be made", error.message());
  }
  void writeText(const std::string& name, const std::string& text) const { writeBytes(name, text.data(), text.size()); }
  void writePng(const std::string& name, const cv::Mat& image) {
    // The fastest compression: a sensor's noise does not shrink much further, and a live camera does not wait.
    cv::imencode(".png", image, bytes_, {cv::IMWRITE_PNG_COMPRESSION, 1});
    writeBytes(name, reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  }
  [[nodiscard]] std::ofstream openList(const char* name, const std::string& heading) const {
    std::ofstream list(folder_ / name);
    if (!list) throw IoError(folder_ / name, "a file that can be written", "none");
    if (!heading.empty()) list << heading << '\n';
    requireWritten(list, folder_ / name);
    return list;
  }
  void appendLine(std::ofstream& list, const char* name, const std::string& line) const {
    list << line << '\n';
    requireWritten(list, folder_ / name);
  }

 private:
  void writeBytes(const std::string& name, const char* bytes, std::size_t size) const {
    const std::filesystem::path path = folder_ / name;
    std::ofstream file(path, std::ios::binary);
    if (!file) throw IoError(path, "a file that can be written", "none");
    file.write(bytes, static_cast<std::streamsize>(size));
    file.flush();
    if (file) return;
    file.close();
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw IoError(path, "room for the file", "a disk that is full or broken; the frames before it are whole");
  }

  std::filesystem::path folder_;
  std::vector<unsigned char> bytes_;
};

std::string cameraYaml(const RgbdCalibration& calibration, const RecordedDepth& depth) {
  RgbdCalibration stored = calibration;
  stored.depth_units_per_metre = depth.unitsPerMetre();
  return "# written by saccade record; its readers take it before any default\n" + calibrationYaml(stored);
}

/// A number that reads back to the same double.
std::string numbers(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("{} {} {} {} {} {} {}", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::vector<std::string> roundingLoss(const RecordedDepth& depth) {
  if (!depth.rounded()) return {};
  return {fmt::format("depth in metres was rounded to 1/{:g} m", depth.unitsPerMetre())};
}

class TumRecorder final : public RecordingWriter {
 public:
  TumRecorder(const std::filesystem::path& folder, const RgbdCalibration& calibration)
      : files_(folder), depth_(calibration) {
    files_.makeFolder("rgb");
    files_.makeFolder("depth");
    files_.writeText("camera.yaml", cameraYaml(calibration, depth_));
    color_list_ = files_.openList("rgb.txt", "# timestamp filename");
    depth_list_ = files_.openList("depth.txt", "# timestamp filename");
    poses_ = files_.openList("groundtruth.txt", "# timestamp tx ty tz qx qy qz qw");
  }

  void write(const SensorFrame& frame) override {
    const std::string file = uniqueName(frame) + ".png";
    const std::string stamp = fmt::format("{}", frame.stamp_s);
    files_.writePng("rgb/" + file, frame.color);
    if (frame.hasDepth()) files_.writePng("depth/" + file, depth_.of(frame));
    if (!frame.label.empty()) {
      if (!has_labels_) files_.makeFolder("label");
      has_labels_ = true;
      files_.writePng("label/" + file, frame.label);
    }
    if (frame.T_WC) files_.appendLine(poses_, "groundtruth.txt", stamp + " " + numbers(*frame.T_WC));
    if (frame.hasDepth()) files_.appendLine(depth_list_, "depth.txt", fmt::format("{} depth/{}", stamp, file));
    files_.appendLine(color_list_, "rgb.txt", fmt::format("{} rgb/{}", stamp, file));
  }
  void finish() override {}
  [[nodiscard]] std::vector<std::string> losses() const override { return roundingLoss(depth_); }

 private:
  std::string uniqueName(const SensorFrame& frame) {
    std::string name = frame.name;
    const bool usable = !name.empty() && name.find_first_of("/ ,\t") == std::string::npos && names_.count(name) == 0;
    if (!usable) name = fmt::format("{:06}", names_.size());
    while (names_.count(name) != 0) name += "_";
    names_.insert(name);
    return name;
  }

  FolderFiles files_;
  RecordedDepth depth_;
  std::ofstream color_list_, depth_list_, poses_;
  std::set<std::string> names_;
  bool has_labels_ = false;
};

class SevenScenesRecorder final : public RecordingWriter {
 public:
  SevenScenesRecorder(const std::filesystem::path& folder, const RgbdCalibration& calibration)
      : files_(folder), depth_(calibration), T_CD_(calibration.depth ? calibration.depth->T_CD : Pose::Identity()) {
    files_.writeText("camera.yaml", cameraYaml(calibration, depth_));
    stamps_ = files_.openList("timestamps.txt", "# frame seconds");
  }

  void write(const SensorFrame& frame) override {
    const std::string stem = fmt::format("frame-{:06}", written_++);
    if (frame.hasDepth()) files_.writePng(stem + ".depth.png", depth_.of(frame));
    if (frame.T_WC) files_.writeText(stem + ".pose.txt", poseMatrix(*frame.T_WC * T_CD_));
    files_.appendLine(stamps_, "timestamps.txt", fmt::format("{} {}", stem, frame.stamp_s));
    lost_labels_ |= !frame.label.empty();
    files_.writePng(stem + ".color.png", frame.color);
  }
  void finish() override {}
  [[nodiscard]] std::vector<std::string> losses() const override {
    std::vector<std::string> losses = roundingLoss(depth_);
    if (lost_labels_) losses.emplace_back("labels have no place in a 7-Scenes folder");
    return losses;
  }

 private:
  /// 7-Scenes keeps the poses of the depth camera.
  static std::string poseMatrix(const Pose& T_WD) {
    std::string text;
    for (int i = 0; i < 4; ++i) {
      const Eigen::RowVector4d row = T_WD.matrix().row(i);
      text += fmt::format("{} {} {} {}\n", row[0], row[1], row[2], row[3]);
    }
    return text;
  }

  FolderFiles files_;
  RecordedDepth depth_;
  Pose T_CD_;
  std::ofstream stamps_;
  std::int64_t written_ = 0;
  bool lost_labels_ = false;
};

}  // namespace

std::unique_ptr<RecordingWriter> makeTumRecorder(const std::filesystem::path& folder,
                                                 const RgbdCalibration& calibration) {
  return std::make_unique<TumRecorder>(folder, calibration);
}

std::unique_ptr<RecordingWriter> makeSevenScenesRecorder(const std::filesystem::path& folder,
                                                         const RgbdCalibration& calibration) {
  return std::make_unique<SevenScenesRecorder>(folder, calibration);
}

}  // namespace saccade
