#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "saccade/core/errors.hpp"
#include "sources/oni_file.hpp"
#include "sources/oni_first_stamps.hpp"
#include "sources/openni2_library.hpp"
#include "sources/recorders.hpp"
#include "virtual_camera/depth_format.hpp"
#include "virtual_camera/virtual_camera_protocol.hpp"

namespace saccade {
namespace {

/// OpenNI2's codec of depth ends an image with its last difference before the run of equal pixels that it follows, so
/// that up to 29 pixels come out wrong. Without that difference nothing is wrong but the last pixel. Returns whether it
/// had to be changed.
bool spareLastPixel(cv::Mat1w& depth) {
  const std::size_t pixels = depth.total();
  if (pixels < 3 || !depth.isContinuous()) return false;
  ushort* const end = depth[0] + pixels;
  if (end[-1] == end[-2] || end[-2] != end[-3]) return false;
  end[-1] = end[-2];
  return true;
}

/// OpenNI2 records only what its devices send, so the frames are fed to the virtual camera, which sends them.
class OniRecorder final : public RecordingWriter {
 public:
  OniRecorder(const std::filesystem::path& path, const RgbdCalibration& calibration)
      : file_(path),
        calibration_(calibration),
        format_(virtual_camera::depthFormatFor(calibration)),
        recorded_depth_(calibration),
        library_(path.string()) {
    const PinholeCamera& color = calibration.color;
    const PinholeCamera& depth = calibration.depth ? calibration.depth->camera : calibration.color;
    const std::string uri = fmt::format("{}{}#color={}x{}&depth={}x{}&color_focal={}x{}&depth_focal={}x{}&unit={}",
                                        virtual_camera::kUriPrefix, virtual_camera::kPushName, color.width,
                                        color.height, depth.width, depth.height, color.fx, color.fy, depth.fx, depth.fy,
                                        format_ == ONI_PIXEL_FORMAT_DEPTH_1_MM ? "mm" : "100um");
    try {
      streams_.open(uri.c_str(), path.string());
    } catch (const IoError&) {
      throw IoError(path, "Saccade's virtual camera among OpenNI2's drivers, which writes .oni files",
                    "none (it is installed in lib/saccade/openni2; OpenNI2 was taken from another place)");
    }
    const bool started = recorder_.create(file_.partialPath().c_str()) == openni::STATUS_OK &&
                         recorder_.attach(streams_.color, false) == openni::STATUS_OK &&
                         recorder_.attach(streams_.depth, false) == openni::STATUS_OK &&
                         streams_.color.start() == openni::STATUS_OK && streams_.depth.start() == openni::STATUS_OK &&
                         recorder_.start() == openni::STATUS_OK;
    if (!started) throw IoError(file_.partialPath(), "a recording that can be started", openNi2Error());
    awaitRecorded();  // frames that come before the recorder's thread has started are forgotten
  }

  void write(const SensorFrame& frame) override {
    virtual_camera::PushedFrame pushed;
    cv::cvtColor(frame.color, rgb_, cv::COLOR_BGR2RGB);
    pushed.rgb = rgb_.data;
    if (frame.hasDepth()) {
      beyond_ += virtual_camera::toOpenNi2Depth(recorded_depth_.of(frame), calibration_, format_, depth_);
      spared_ += spareLastPixel(depth_) ? 1 : 0;
      pushed.depth = depth_[0];
    }
    pushed.stamp_us = stampIn(kMicroseconds, frame.stamp_s);
    if (streams_.device.invoke(virtual_camera::kPushCommand, &pushed, sizeof pushed) != openni::STATUS_OK) {
      throw IoError(file_.partialPath(), "a frame that can be recorded", openNi2Error());
    }
    if (color_frames_ == 0) first_stamps_.color_us = pushed.stamp_us;
    if (pushed.depth != nullptr && depth_frames_ == 0) first_stamps_.depth_us = pushed.stamp_us;
    depth_frames_ += pushed.depth != nullptr ? 1 : 0;
    // Frames wait in memory to be written: a slow disk must not fill it.
    constexpr int kMostWaiting = 32;
    if (++color_frames_ % kMostWaiting == 0) awaitRecorded();
    lost_labels_ |= !frame.label.empty();
    lost_poses_ |= frame.T_WC.has_value();
  }

  void finish() override {
    awaitRecorded();
    recorder_.stop();
    recorder_.destroy();
    streams_.close();
    const OniFileExtent extent = readOniExtent(file_.partialPath());
    requireAllFrames(extent);
    closeOniGap(file_.partialPath(), extent);
    writeSideFile();
    file_.complete();
  }

  [[nodiscard]] std::vector<std::string> losses() const override {
    std::vector<std::string> losses;
    const double units = recorded_depth_.unitsPerMetre();
    if (recorded_depth_.rounded() || (units != 1000.0 && units != 5000.0 && units != 10000.0)) {
      losses.emplace_back("depth was rounded to 0.1 mm");
    }
    if (beyond_ > 0) losses.push_back(fmt::format("{} depth pixels beyond 6.55 m, the most in 0.1 mm", beyond_));
    if (spared_ > 0) {
      losses.push_back(fmt::format("the last pixel of depth in {} frames, where OpenNI2's codec fails", spared_));
    }
    if (lost_labels_) losses.emplace_back("labels have no place in an .oni file");
    if (lost_poses_) losses.emplace_back("poses have no place in an .oni file");
    return losses;
  }

 private:
  /// OpenNI2 records on a thread of its own and forgets what is on the way when it is stopped, without a word. It takes
  /// frames and properties in order: once a property is in the file, all frames before it are too.
  void awaitRecorded() {
    using namespace std::chrono_literals;
    constexpr auto kStep = 2ms, kPatience = 15000ms;
    std::string mark = fmt::format("saccade-recorded-{:08}", ++marks_);
    openni::Status marked = openni::STATUS_OUT_OF_FLOW;  // until the recorder's thread has begun
    std::uintmax_t last_size = 0;
    for (auto waited = 0ms; waited < kPatience; waited += kStep) {
      if (marked == openni::STATUS_OUT_OF_FLOW) {
        marked = streams_.device.invoke(virtual_camera::kMarkCommand, mark.data(), static_cast<int>(mark.size()));
      }
      if (marked != openni::STATUS_OK && marked != openni::STATUS_OUT_OF_FLOW) {
        throw IoError(file_.partialPath(), "a recording that can be marked", openNi2Error());
      }
      std::error_code unknown;
      const std::uintmax_t size = std::filesystem::file_size(file_.partialPath(), unknown);
      if (!unknown && size != last_size) waited = 0ms;
      last_size = size;
      if (!unknown && fileEndHas(mark)) return;
      std::this_thread::sleep_for(kStep);
    }
    throw IoError(file_.partialPath(), "room for the recording", "a file that no longer grows");
  }

  [[nodiscard]] bool fileEndHas(const std::string& mark) const {
    constexpr std::streamoff kEnd = 4096;  // more than a property takes
    std::ifstream file(file_.partialPath(), std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : 0;
    std::string end(static_cast<std::size_t>(std::min(size, kEnd)), '\0');
    file.seekg(size - static_cast<std::streamoff>(end.size()));
    file.read(end.data(), static_cast<std::streamsize>(end.size()));
    return end.find(mark) != std::string::npos;
  }

  /// OpenNI2 does not tell when a disk is full; the file itself does.
  void requireAllFrames(const OniFileExtent& extent) const {
    std::int64_t frames = 0;
    for (const OniStreamExtent& stream : extent.streams) frames += stream.frames;
    if (extent.is_known_format && extent.isWhole() && frames == color_frames_ + depth_frames_) return;
    throw IoError(file_.partialPath(),
                  fmt::format("room for {} frames of colour and {} of depth", color_frames_, depth_frames_),
                  fmt::format("{} frames in the file", frames));
  }

  void writeSideFile() const {
    RgbdCalibration stored = calibration_;
    stored.depth_units_per_metre = virtual_camera::unitsPerMetre(format_);
    stored.depth_invalid.clear();
    std::filesystem::path side = file_.path();
    side += ".yaml";
    std::ofstream yaml(side);
    yaml << "# written by saccade record: the full calibration, of which .oni files only keep the field of view\n"
         << calibrationYaml(stored) << oniFirstStampsYaml(first_stamps_);
    yaml.flush();
    if (!yaml) throw IoError(side, "room for the calibration", "it could not be written in full");
  }

  PartialFile file_;
  RgbdCalibration calibration_;
  OniPixelFormat format_;
  RecordedDepth recorded_depth_;
  OpenNi2Library library_;
  OpenNi2Streams streams_;
  openni::Recorder recorder_;
  cv::Mat3b rgb_;
  cv::Mat1w depth_;
  OniFirstStamps first_stamps_;
  std::int64_t beyond_ = 0, spared_ = 0;
  int color_frames_ = 0, depth_frames_ = 0, marks_ = 0;
  bool lost_labels_ = false, lost_poses_ = false;
};

}  // namespace

std::unique_ptr<RecordingWriter> makeOniRecorder(const std::filesystem::path& file,
                                                 const RgbdCalibration& calibration) {
  return std::make_unique<OniRecorder>(file, calibration);
}

}  // namespace saccade
