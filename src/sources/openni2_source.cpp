#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "sources/ideal_frames.hpp"
#include "sources/openni2_library.hpp"
#include "sources/recorders.hpp"
#include "sources/recording_files.hpp"
#include "sources/stamp_pairer.hpp"

namespace saccade {
namespace {

// Pairs that wait to be read; more are dropped, the oldest first.
constexpr std::size_t kMostWaiting = 8;
// read() comes back at least so often, so that a user's Ctrl-C is heard while nothing comes.
constexpr std::chrono::milliseconds kLongestWait(1000);
// An unplugged camera may come back within this time.
constexpr std::chrono::seconds kReplugTime(10);
constexpr std::chrono::milliseconds kLookInterval(20);
constexpr const char* kCalibrationKey = "?calibration=";

/// Pairs of colour and depth on their way from OpenNI2's threads to the reader.
class PairQueue {
 public:
  struct Item {
    double stamp_s = 0.0;
    cv::Mat3b color;
    cv::Mat1w depth;
  };

  void addColor(double stamp_s, const cv::Mat3b& color) {
    const std::lock_guard lock(mutex_);
    pairer_.addFirst(stamp_s, color);
    collect();
  }
  void addDepth(double stamp_s, const cv::Mat1w& depth) {
    const std::lock_guard lock(mutex_);
    pairer_.addSecond(stamp_s, depth);
    collect();
  }
  void countLost(std::int64_t frames) {
    const std::lock_guard lock(mutex_);
    dropped_ += frames;
  }
  /// Wakes a reader up that waits.
  void wake() { changed_.notify_all(); }
  std::optional<Item> take(std::chrono::milliseconds longest_wait) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, longest_wait, [this] { return !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    Item item = std::move(items_.front());
    items_.pop_front();
    return item;
  }
  [[nodiscard]] std::int64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  void collect() {
    while (auto pair = pairer_.next()) {
      items_.push_back({pair->first_stamp_s, std::move(pair->first), std::move(pair->second)});
      if (items_.size() <= kMostWaiting) continue;
      items_.pop_front();
      ++dropped_;
    }
    if (!items_.empty()) changed_.notify_all();
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  StampPairer<cv::Mat3b, cv::Mat1w> pairer_;
  std::deque<Item> items_;
  std::int64_t dropped_ = 0;
};

/// Takes the frames of one stream off OpenNI2's hands as they come. Frames whose numbers it missed count as lost.
template <typename Image>
class FrameCatcher final : public openni::VideoStream::NewFrameListener {
 public:
  FrameCatcher(PairQueue& queue, void (*copy)(const openni::VideoFrameRef&, Image&),
               void (PairQueue::*add)(double, const Image&), bool counts_lost)
      : queue_(queue), copy_(copy), add_(add), counts_lost_(counts_lost) {}

  void onNewFrame(openni::VideoStream& stream) override {
    openni::VideoFrameRef frame;
    if (stream.readFrame(&frame) != openni::STATUS_OK || !frame.isValid()) return;
    const int index = frame.getFrameIndex();
    if (counts_lost_ && last_index_ > 0 && index > last_index_ + 1) queue_.countLost(index - last_index_ - 1);
    last_index_ = index;
    Image image;
    copy_(frame, image);
    (queue_.*add_)(secondsOf(static_cast<std::int64_t>(frame.getTimestamp()), kMicroseconds), image);
  }

 private:
  PairQueue& queue_;
  void (*copy_)(const openni::VideoFrameRef&, Image&);
  void (PairQueue::*add_)(double, const Image&);
  bool counts_lost_;
  int last_index_ = 0;
};

/// Hears of cameras that come and go. Called by OpenNI2's threads, hence only notes.
class PlugListener final : public openni::OpenNI::DeviceDisconnectedListener,
                           public openni::OpenNI::DeviceConnectedListener {
 public:
  PlugListener(std::string uri, PairQueue& queue) : uri_(std::move(uri)), queue_(queue) {
    openni::OpenNI::addDeviceDisconnectedListener(this);
    openni::OpenNI::addDeviceConnectedListener(this);
  }
  ~PlugListener() override {
    openni::OpenNI::removeDeviceConnectedListener(this);
    openni::OpenNI::removeDeviceDisconnectedListener(this);
  }
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    if (uri_ != info->getUri()) return;
    plugged_ = false;
    queue_.wake();
  }
  void onDeviceConnected(const openni::DeviceInfo* info) override {
    if (uri_ != info->getUri()) return;
    plugged_ = true;
    queue_.wake();
  }
  [[nodiscard]] bool plugged() const { return plugged_; }

 private:
  std::string uri_;
  PairQueue& queue_;
  std::atomic<bool> plugged_{true};
};

class OpenNi2Source final : public SensorSource {
 public:
  OpenNi2Source(const std::string& text, const FrameRange& range) : library_("openni2:" + text), cursor_(range) {
    const std::size_t key = text.find(kCalibrationKey);
    uri_ = text.substr(0, key);
    description_.location = "openni2:" + uri_;
    streams_.open(uri_.empty() ? openni::ANY_DEVICE : uri_.c_str(), description_.location);
    uri_ = streams_.device.getDeviceInfo().getUri();
    if (key != std::string::npos) {
      calibration_ = loadCalibrationYaml(text.substr(key + std::string(kCalibrationKey).size()));
    } else {
      calibration_ = calibrationOf(streams_, description_.location, description_.remarks);
    }
    calibration_.depth_units_per_metre = depthUnitsPerMetre(streams_.depth, description_.location);
    describe();
    plug_.emplace(uri_, queue_);
    start();
  }
  ~OpenNi2Source() override { stop(); }

  [[nodiscard]] const RgbdCalibration& calibration() const override { return calibration_; }
  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] const std::string& skipReason() const override { return skip_reason_; }
  [[nodiscard]] SourceProgress progress() const override { return {queue_.dropped(), end_reason_}; }

  [[nodiscard]] ReadStatus read(SensorFrame& frame) override {
    while (!cursor_.passed()) {
      const std::optional<PairQueue::Item> item = queue_.take(plug_->plugged() ? kLongestWait : kNoWait);
      if (!item) return waitForCamera();
      unplugged_since_.reset();
      if (!cursor_.take()) continue;
      frame.index = cursor_.last();
      frame.name = fmt::format("{:06}", frame.index.value);
      frame.stamp_s = item->stamp_s;
      frame.T_WC.reset();
      frame.color = item->color;
      frame.raw_depth = item->depth;
      return ReadStatus::kFrame;
    }
    return ReadStatus::kEnd;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kNoWait{0};

  void describe() {
    description_.kind = "OpenNI2 camera";
    description_.is_live = true;
    description_.frames = description_.total_frames = -1;
    description_.has_depth = true;
    description_.depth_scale_origin = "the depth stream's pixel format";
    const openni::DeviceInfo& info = streams_.device.getDeviceInfo();
    description_.remarks.push_back(fmt::format("{} {}, {}", info.getVendor(), info.getName(), uri_));
    describeCalibration(calibration_, description_);
  }

  void start() {
    color_catcher_ = std::make_unique<FrameCatcher<cv::Mat3b>>(queue_, copyColor, &PairQueue::addColor, true);
    depth_catcher_ = std::make_unique<FrameCatcher<cv::Mat1w>>(queue_, copyDepth, &PairQueue::addDepth, false);
    streams_.color.addNewFrameListener(color_catcher_.get());
    streams_.depth.addNewFrameListener(depth_catcher_.get());
    if (streams_.depth.start() != openni::STATUS_OK || streams_.color.start() != openni::STATUS_OK) {
      throw IoError(description_.location, "streams that can be started", openNi2Error());
    }
  }

  void stop() {
    if (streams_.color.isValid()) streams_.color.removeNewFrameListener(color_catcher_.get());
    if (streams_.depth.isValid()) streams_.depth.removeNewFrameListener(depth_catcher_.get());
    streams_.close();
  }

  /// Nothing came: the camera is slow, or gone. One that is gone is opened again as soon as it is back.
  ReadStatus waitForCamera() {
    if (!end_reason_.empty()) return ReadStatus::kEnd;
    if (plug_->plugged() && !unplugged_since_) {
      skip_reason_ = description_.location + ": no frame for 1 s";
      return ReadStatus::kSkip;
    }
    const Clock::time_point now = Clock::now();
    if (!unplugged_since_) {
      unplugged_since_ = now;
      stop();
      skip_reason_ = fmt::format("{}: the camera was unplugged; waiting up to {} s for it to come back",
                                 description_.location, kReplugTime.count());
      return ReadStatus::kSkip;
    }
    if (now - *unplugged_since_ >= kReplugTime) {
      end_reason_ = fmt::format("{}: the camera was unplugged and did not come back within {} s", description_.location,
                                kReplugTime.count());
      return ReadStatus::kEnd;
    }
    if (plug_->plugged()) return reopen();
    // Not a busy wait, and not so long that a Ctrl-C goes unheard.
    for (const Clock::time_point until = now + kLongestWait; !plug_->plugged() && Clock::now() < until;) {
      std::this_thread::sleep_for(kLookInterval);
    }
    if (plug_->plugged()) return reopen();
    skip_reason_ = description_.location + ": still unplugged";
    return ReadStatus::kSkip;
  }

  ReadStatus reopen() {
    try {
      streams_.open(uri_.c_str(), description_.location);
      start();
      unplugged_since_.reset();
      skip_reason_ = description_.location + ": the camera is back";
    } catch (const IoError& error) {
      stop();
      skip_reason_ = error.what();
    }
    return ReadStatus::kSkip;
  }

  OpenNi2Library library_;
  PairQueue queue_;
  std::string uri_;
  RangeCursor cursor_;
  std::optional<PlugListener> plug_;
  std::unique_ptr<FrameCatcher<cv::Mat3b>> color_catcher_;
  std::unique_ptr<FrameCatcher<cv::Mat1w>> depth_catcher_;
  OpenNi2Streams streams_;
  std::optional<Clock::time_point> unplugged_since_;
  std::string skip_reason_, end_reason_;
  RgbdCalibration calibration_;
  SourceDescription description_;
};

}  // namespace

std::unique_ptr<SensorSource> openOpenNi2(const std::string& uri, const FrameRange& range) {
  return std::make_unique<OpenNi2Source>(uri, range);
}

}  // namespace saccade
