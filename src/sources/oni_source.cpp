#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "sources/ideal_frames.hpp"
#include "sources/oni_file.hpp"
#include "sources/oni_first_stamps.hpp"
#include "sources/openni2_library.hpp"
#include "sources/recorders.hpp"
#include "sources/recording_files.hpp"
#include "sources/stamp_pairer.hpp"

namespace saccade {
namespace {

// The player reads on while it waits; a file that gives nothing for so long is cut off.
constexpr std::chrono::milliseconds kPatience(3000);

class OniSource final : public SensorSource {
 public:
  OniSource(const std::filesystem::path& path, const FrameRange& range)
      : path_(path), library_(path.string()), cursor_(range) {
    requireWhole();
    streams_.open(std::filesystem::absolute(path).c_str(), path.string());
    settleCalibration();
    openni::PlaybackControl* playback = streams_.device.getPlaybackControl();
    constexpr float kAsFastAsRead = -1.0f;
    // The end is known by counting. A player that has come to an end without repeating may crash when it is closed.
    if (playback == nullptr || playback->setSpeed(kAsFastAsRead) != openni::STATUS_OK ||
        playback->setRepeatEnabled(true) != openni::STATUS_OK) {
      throw IoError(path, "a recording that can be played", openNi2Error());
    }
    unread_[kColor] = playback->getNumberOfFrames(streams_.color);
    unread_[kDepth] = playback->getNumberOfFrames(streams_.depth);
    if (unread_[kColor] <= 0 || unread_[kDepth] <= 0) {
      throw IoError(path, "frames in both streams",
                    fmt::format("{} of colour and {} of depth", unread_[kColor], unread_[kDepth]));
    }
    describe();
    if (streams_.color.start() != openni::STATUS_OK || streams_.depth.start() != openni::STATUS_OK) {
      throw IoError(path, "streams that can be started", openNi2Error());
    }
    std::size_t ignored = 0;
    if (streams_.awaitFrame({&streams_.color, &streams_.depth}, kPatience, ignored) != openni::STATUS_OK) {
      throw IoError(path, "frames", fmt::format("none within {} s", kPatience.count() / 1000));
    }
  }

  [[nodiscard]] const RgbdCalibration& calibration() const override { return calibration_; }
  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }
  [[nodiscard]] SourceProgress progress() const override { return {0, end_reason_}; }

  [[nodiscard]] ReadStatus read(SensorFrame& frame) override {
    ReadStatus status = ReadStatus::kEnd;
    lasting_.run([&] { status = readNext(frame); });
    return status;
  }

 private:
  [[nodiscard]] ReadStatus readNext(SensorFrame& frame) {
    while (!cursor_.passed()) {
      auto pair = pairer_.next();
      while (!pair && advance()) pair = pairer_.next();
      if (!pair) return ReadStatus::kEnd;
      if (!cursor_.take()) continue;
      frame.index = cursor_.last();
      frame.name = fmt::format("{:06}", frame.index.value);
      frame.stamp_s = pair->first_stamp_s;
      frame.T_WC.reset();
      frame.color = pair->first;
      frame.raw_depth = pair->second;
      return ReadStatus::kFrame;
    }
    return ReadStatus::kEnd;
  }

  enum Place { kColor, kDepth, kPlaces };

  /// The player opens no recording that is cut off, and does not say why.
  void requireWhole() const {
    const OniFileExtent extent = readOniExtent(path_);
    if (!extent.is_known_format || extent.isWhole()) return;
    std::string found;
    for (const OniStreamExtent& stream : extent.streams) {
      found += (found.empty() ? "" : " and ") + std::to_string(stream.frames);
    }
    throw IoError(path_, "a whole OpenNI2 recording",
                  "one that is cut off or was never finished, after " + found + " frames of its streams");
  }

  void settleCalibration() {
    first_stamps_ = findOniFirstStamps(path_);
    if (std::optional<RgbdCalibration> side = findSideCalibration(path_)) {
      calibration_ = *std::move(side);
    } else {
      calibration_ = calibrationOf(streams_, path_.string(), description_.remarks);
    }
    const double units = depthUnitsPerMetre(streams_.depth, path_.string());
    description_.depth_scale_origin = "the depth stream's pixel format";
    if (calibration_.depth_units_per_metre > 0 && calibration_.depth_units_per_metre != units) {
      description_.depth_scale_origin = calibration_.origin;
    } else {
      calibration_.depth_units_per_metre = units;
    }
    requireSize(streams_.color, calibration_.color);
    requireSize(streams_.depth, calibration_.depth ? calibration_.depth->camera : calibration_.color);
    if (streams_.color.getVideoMode().getPixelFormat() != openni::PIXEL_FORMAT_RGB888) {
      throw IoError(path_, "colour as RGB888", "another pixel format");
    }
  }

  void requireSize(const openni::VideoStream& stream, const PinholeCamera& camera) const {
    const openni::VideoMode mode = stream.getVideoMode();
    if (mode.getResolutionX() == camera.width && mode.getResolutionY() == camera.height) return;
    throw IoError(path_, fmt::format("images of {} x {} px ({})", camera.width, camera.height, calibration_.origin),
                  fmt::format("{} x {} px", mode.getResolutionX(), mode.getResolutionY()));
  }

  void describe() {
    description_.kind = "OpenNI2 recording";
    description_.location = path_.string();
    description_.frames = description_.total_frames = -1;
    description_.has_depth = true;
    describeCalibration(calibration_, description_);
  }

  /// Hands the next frame of either stream on; false at the end.
  bool advance() {
    if (ended_) return false;
    std::vector<openni::VideoStream*> waiting;
    if (unread_[kColor] > 0) waiting.push_back(&streams_.color);
    if (unread_[kDepth] > 0) waiting.push_back(&streams_.depth);
    if (waiting.empty()) {
      ended_ = true;
      pairer_.end();
      return true;
    }
    std::size_t ready = 0;
    if (streams_.awaitFrame(waiting, kPatience, ready) != openni::STATUS_OK) {
      return giveUp(fmt::format("no frame within {} s", kPatience.count() / 1000));
    }
    openni::VideoStream& stream = *waiting[ready];
    openni::VideoFrameRef frame;
    if (streams_.readFrame(stream, frame) != openni::STATUS_OK) return true;
    const std::size_t place = &stream == &streams_.color ? kColor : kDepth;
    const std::int64_t first_us = place == kColor ? first_stamps_.color_us : first_stamps_.depth_us;
    const double stamp_s = secondsOf(first_us + static_cast<std::int64_t>(frame.getTimestamp()), kMicroseconds);
    if (stamp_s < last_stamp_s_[place]) return giveUp("frames that begin again");
    last_stamp_s_[place] = stamp_s;
    if (place == kColor) {
      --unread_[kColor];
      cv::Mat3b color;
      copyColor(frame, color);
      pairer_.addFirst(stamp_s, color);
    } else {
      --unread_[kDepth];
      cv::Mat1w depth;
      copyDepth(frame, depth);
      pairer_.addSecond(stamp_s, depth);
    }
    return true;
  }

  /// A recording that was cut off: what there was has been read.
  bool giveUp(const std::string& found) {
    end_reason_ = IoError(path_, "a whole recording",
                          fmt::format("{} where {} of colour and {} of depth are still due", found, unread_[kColor],
                                      unread_[kDepth]))
                      .what();
    ended_ = true;
    pairer_.end();
    return true;
  }

  std::filesystem::path path_;
  OpenNi2Library library_;
  OpenNi2Streams streams_;
  LastingThread lasting_;
  RangeCursor cursor_;
  StampPairer<cv::Mat3b, cv::Mat1w> pairer_;
  std::array<int, kPlaces> unread_{};
  std::array<double, kPlaces> last_stamp_s_{std::numeric_limits<double>::lowest(),
                                            std::numeric_limits<double>::lowest()};
  OniFirstStamps first_stamps_;
  bool ended_ = false;
  std::string skip_reason_, end_reason_;
  RgbdCalibration calibration_;
  SourceDescription description_;
};

}  // namespace

std::unique_ptr<SensorSource> openOni(const std::filesystem::path& file, const FrameRange& range) {
  return std::make_unique<OniSource>(file, range);
}

}  // namespace saccade
