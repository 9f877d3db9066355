#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "saccade/core/errors.hpp"
#include "sources/openni2_library.hpp"
#include "sources/recorders.hpp"
#include "virtual_camera/depth_format.hpp"
#include "virtual_camera/virtual_camera_protocol.hpp"

namespace saccade {
namespace {

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
  }

  void write(const SensorFrame& frame) override {
    virtual_camera::PushedFrame pushed;
    cv::cvtColor(frame.color, rgb_, cv::COLOR_BGR2RGB);
    pushed.rgb = rgb_.data;
    if (frame.hasDepth()) {
      virtual_camera::toOpenNi2Depth(recorded_depth_.of(frame), calibration_, format_, depth_);
      pushed.depth = depth_[0];
      ++depth_frames_;
    }
    pushed.stamp_us = static_cast<std::uint64_t>(stampIn(kMicroseconds, frame.stamp_s));
    if (streams_.device.invoke(virtual_camera::kPushCommand, &pushed, sizeof pushed) != openni::STATUS_OK) {
      throw IoError(file_.partialPath(), "a frame that can be recorded", openNi2Error());
    }
    ++color_frames_;
    lost_labels_ |= !frame.label.empty();
    lost_poses_ |= frame.T_WC.has_value();
  }

  void finish() override {
    awaitLastFrame();
    recorder_.stop();
    recorder_.destroy();
    streams_.close();
    requireAllFrames();
    writeSideFile();
    file_.complete();
  }

  [[nodiscard]] std::vector<std::string> losses() const override {
    std::vector<std::string> losses;
    const double units = recorded_depth_.unitsPerMetre();
    if (recorded_depth_.rounded() || (units != 1000.0 && units != 5000.0 && units != 10000.0)) {
      losses.emplace_back("depth was rounded to 0.1 mm");
    }
    if (format_ == ONI_PIXEL_FORMAT_DEPTH_100_UM) losses.emplace_back("depth beyond 6.55 m has no place in 0.1 mm");
    if (lost_labels_) losses.emplace_back("labels have no place in an .oni file");
    if (lost_poses_) losses.emplace_back("poses have no place in an .oni file");
    return losses;
  }

 private:
  /// OpenNI2 records on a thread of its own and forgets what is on the way when it is stopped, without a word. So the
  /// file must have stopped growing; requireAllFrames() judges whether that was enough.
  void awaitLastFrame() const {
    using namespace std::chrono_literals;
    constexpr auto kStep = 20ms, kQuiet = 300ms, kPatience = 20000ms;
    std::uintmax_t last_size = 0;
    auto quiet = 0ms;
    for (auto waited = 0ms; waited < kPatience && quiet < kQuiet; waited += kStep) {
      std::this_thread::sleep_for(kStep);
      std::error_code unknown;
      const std::uintmax_t size = std::filesystem::file_size(file_.partialPath(), unknown);
      quiet = !unknown && size == last_size ? quiet + kStep : 0ms;
      last_size = size;
    }
  }

  /// OpenNI2 does not tell when a disk is full; the recording does, when it is opened again.
  void requireAllFrames() const {
    openni::Device device;
    openni::VideoStream color, depth;
    int colors = 0, depths = 0;
    if (device.open(file_.partialPath().c_str()) == openni::STATUS_OK &&
        color.create(device, openni::SENSOR_COLOR) == openni::STATUS_OK &&
        depth.create(device, openni::SENSOR_DEPTH) == openni::STATUS_OK && device.getPlaybackControl() != nullptr) {
      colors = device.getPlaybackControl()->getNumberOfFrames(color);
      depths = device.getPlaybackControl()->getNumberOfFrames(depth);
    }
    color.destroy();
    depth.destroy();
    device.close();
    if (colors == color_frames_ && depths == depth_frames_) return;
    throw IoError(file_.partialPath(),
                  fmt::format("room for {} frames of colour and {} of depth", color_frames_, depth_frames_),
                  fmt::format("{} and {} in the file", colors, depths));
  }

  void writeSideFile() const {
    RgbdCalibration stored = calibration_;
    stored.depth_units_per_metre = virtual_camera::unitsPerMetre(format_);
    stored.depth_invalid.clear();
    std::filesystem::path side = file_.path();
    side += ".yaml";
    std::ofstream yaml(side);
    yaml << "# written by saccade record: the full calibration, of which .oni files only keep the field of view\n"
         << calibrationYaml(stored);
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
  int color_frames_ = 0, depth_frames_ = 0;
  bool lost_labels_ = false, lost_poses_ = false;
};

}  // namespace

std::unique_ptr<RecordingWriter> makeOniRecorder(const std::filesystem::path& file,
                                                 const RgbdCalibration& calibration) {
  return std::make_unique<OniRecorder>(file, calibration);
}

}  // namespace saccade
