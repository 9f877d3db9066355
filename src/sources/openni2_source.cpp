#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

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
    return dropped_ + pairer_.droppedFirst();
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

/// Takes the frames of both streams off OpenNI2's hands, on a thread of its own, from construction to destruction.
/// Colour frames whose numbers it missed count as lost.
///
/// Not with OpenNI2's listeners. OpenNI2 calls one with the stream's event locked, once for each frame but without
/// queueing frames: where two came at once, the first call takes the newer, and the second one's readFrame(), which
/// knows no time limit, waits for a third. If the camera is gone there is none, and whoever removes the listener waits
/// for the event's lock for ever. Here a frame is only read once it is known to be there, by the only reader there is.
class FrameCatcher {
 public:
  /// `last_index` is the number of the last colour frame, also of a camera that was away meanwhile; negative: not
  /// known.
  FrameCatcher(OpenNi2Streams& streams, PairQueue& queue, int& last_index)
      : streams_(streams),
        queue_(queue),
        last_index_(last_index),
        thread_([this] { lasting_.run([this] { run(); }); }) {}
  ~FrameCatcher() {
    stopping_ = true;
    thread_.join();
  }
  FrameCatcher(const FrameCatcher&) = delete;
  FrameCatcher& operator=(const FrameCatcher&) = delete;

 private:
  /// Goes on until there is nothing left to take, so that the last frames of an unplugged camera are not lost.
  void run() {
    constexpr std::chrono::milliseconds kLongestWait(50);  // what closing the camera may have to wait
    while (true) {
      const std::vector<openni::VideoStream*> both = {&streams_.color, &streams_.depth};
      std::size_t ready = 0;
      const bool last_look = stopping_;
      const openni::Status status =
          streams_.awaitFrame(both, last_look ? std::chrono::milliseconds(0) : kLongestWait, ready);
      if (status == openni::STATUS_OK) {
        take(*both[ready]);
      } else if (last_look) {
        return;
      } else if (status != openni::STATUS_TIME_OUT) {
        std::this_thread::sleep_for(kLongestWait);  // not a busy wait on a broken device
      }
    }
  }

  void take(openni::VideoStream& stream) {
    openni::VideoFrameRef frame;
    if (streams_.readFrame(stream, frame) != openni::STATUS_OK || !frame.isValid()) return;
    const double stamp_s = secondsOf(static_cast<std::int64_t>(frame.getTimestamp()), kMicroseconds);
    if (&stream == &streams_.depth) {
      cv::Mat1w depth;
      copyDepth(frame, depth);
      queue_.addDepth(stamp_s, depth);
      return;
    }
    const int index = frame.getFrameIndex();
    if (last_index_ >= 0 && index > last_index_ + 1) queue_.countLost(index - last_index_ - 1);
    last_index_ = index;
    cv::Mat3b color;
    copyColor(frame, color);
    queue_.addColor(stamp_s, color);
  }

  OpenNi2Streams& streams_;
  PairQueue& queue_;
  int& last_index_;
  std::atomic<bool> stopping_{false};
  LastingThread lasting_;
  std::thread thread_;  // last: it uses the others
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
    was_unplugged_ = true;
    queue_.wake();
  }
  void onDeviceConnected(const openni::DeviceInfo* info) override {
    if (uri_ != info->getUri()) return;
    plugged_ = true;
    queue_.wake();
  }
  [[nodiscard]] bool plugged() const { return plugged_; }
  /// Whether the camera went away since this was last asked, even if it is back.
  [[nodiscard]] bool tookUnplugging() { return was_unplugged_.exchange(false); }

 private:
  std::string uri_;
  PairQueue& queue_;
  std::atomic<bool> plugged_{true}, was_unplugged_{false};
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
    if (numbersFromOne(streams_.device)) last_color_index_ = 0;
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
      const std::optional<PairQueue::Item> item =
          queue_.take(plug_->plugged() && !unplugged_since_ ? kLongestWait : kNoWait);
      if (!item) return waitForCamera();
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
    if (streams_.depth.start() != openni::STATUS_OK || streams_.color.start() != openni::STATUS_OK) {
      throw IoError(description_.location, "streams that can be started", openNi2Error());
    }
    catcher_.emplace(streams_, queue_, last_color_index_);
  }

  void stop() {
    catcher_.reset();
    streams_.close();
  }

  /// Nothing came: the camera is slow, or gone. One that is gone is opened again as soon as it is back.
  ReadStatus waitForCamera() {
    if (!end_reason_.empty()) return ReadStatus::kEnd;
    const Clock::time_point now = Clock::now();
    if (!unplugged_since_) {
      if (!plug_->tookUnplugging()) {
        skip_reason_ = description_.location + ": no frame for 1 s";
        return ReadStatus::kSkip;
      }
      unplugged_since_ = now;
      lasting_.run([this] { stop(); });
      skip_reason_ = fmt::format("{}: the camera was unplugged; waiting up to {} s for it to come back",
                                 description_.location, kReplugTime.count());
      return ReadStatus::kSkip;
    }
    if (now - *unplugged_since_ >= kReplugTime) {
      end_reason_ = fmt::format("{}: the camera was unplugged and did not come back within {} s", description_.location,
                                kReplugTime.count());
      return ReadStatus::kEnd;
    }
    if (plug_->plugged()) return reopened();
    // Not a busy wait, and not so long that a Ctrl-C goes unheard.
    for (const Clock::time_point until = now + kLongestWait; !plug_->plugged() && Clock::now() < until;) {
      std::this_thread::sleep_for(kLookInterval);
    }
    if (plug_->plugged()) return reopened();
    skip_reason_ = description_.location + ": still unplugged";
    return ReadStatus::kSkip;
  }

  ReadStatus reopened() {
    lasting_.run([this] { reopen(); });
    return ReadStatus::kSkip;
  }

  /// Opens the camera again; `skip_reason_` tells how that went.
  void reopen() {
    try {
      streams_.open(uri_.c_str(), description_.location);
      start();
      unplugged_since_.reset();
      skip_reason_ = description_.location + ": the camera is back";
    } catch (const IoError& error) {
      stop();
      skip_reason_ = error.what();
    }
  }

  OpenNi2Library library_;
  PairQueue queue_;
  std::string uri_;
  RangeCursor cursor_;
  std::optional<PlugListener> plug_;
  OpenNi2Streams streams_;
  LastingThread lasting_;
  int last_color_index_ = -1;
  std::optional<FrameCatcher> catcher_;
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
