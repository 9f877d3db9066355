#include "saccade/sources/read_ahead.hpp"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace saccade {
namespace {

constexpr int kMostFramesAhead = 64;

/// What one read of the source came to.
struct Outcome {
  ReadStatus status = ReadStatus::kEnd;
  RgbdFrame frame;
  std::string skip_reason;
  std::exception_ptr error;

  [[nodiscard]] bool isLast() const { return error || status == ReadStatus::kEnd; }
};

template <typename Image>
void leaveSharedPixels(Image& image) {
  if (image.u != nullptr && image.u->refcount > 1) image.release();
}

}  // namespace

struct ReadAhead::Queue {
  Queue(std::unique_ptr<FrameSource> owned, int frames_ahead)
      : source(std::move(owned)),
        description(source->description()),
        ring(static_cast<std::size_t>(frames_ahead)),
        thread([this] { decode(); }) {}

  ~Queue() {
    {
      const std::lock_guard lock(mutex);
      stopped = true;
    }
    changed.notify_all();
    thread.join();
  }

  // The thread owns ring[(first + filled) % size] while it decodes; the reader touches only filled places. A live
  // source goes on whatever the reader does, so its oldest frame makes room.
  void decode() {
    for (bool last = false; !last;) {
      std::unique_lock lock(mutex);
      if (description.is_live && filled == ring.size()) {
        if (ring[first].status == ReadStatus::kFrame) ++dropped;
        first = (first + 1) % ring.size();
        --filled;
      }
      changed.wait(lock, [this] { return stopped || filled < ring.size(); });
      if (stopped) return;
      Outcome& outcome = ring[(first + filled) % ring.size()];
      lock.unlock();

      readInto(outcome);
      last = outcome.isLast();
      const SourceProgress now = source->progress();

      lock.lock();
      progress = now;
      ++filled;
      lock.unlock();
      changed.notify_all();
    }
  }

  void readInto(Outcome& outcome) {
    leaveSharedPixels(outcome.frame.color);
    leaveSharedPixels(outcome.frame.depth_m);
    leaveSharedPixels(outcome.frame.label);
    try {
      outcome.status = source->read(outcome.frame);
      if (outcome.status == ReadStatus::kSkip) outcome.skip_reason = source->skipReason();
    } catch (...) {
      outcome.error = std::current_exception();
    }
  }

  std::unique_ptr<FrameSource> source;
  const SourceDescription description;  // a copy: the source belongs to the thread
  std::string skip_reason;

  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Outcome> ring;
  std::size_t first = 0, filled = 0;
  bool stopped = false;
  SourceProgress progress;   // of the source
  std::int64_t dropped = 0;  // here
  std::thread thread;        // last: it starts when all above is ready
};

ReadAhead::ReadAhead(std::unique_ptr<FrameSource> source, int frames_ahead) {
  if (!source || frames_ahead < 1 || frames_ahead > kMostFramesAhead) {
    throw std::invalid_argument("ReadAhead: expected a source and 1 to " + std::to_string(kMostFramesAhead) +
                                " frames ahead, found " + (source ? std::to_string(frames_ahead) : "no source"));
  }
  queue_ = std::make_unique<Queue>(std::move(source), frames_ahead);
}

ReadAhead::~ReadAhead() = default;

const SourceDescription& ReadAhead::description() const {
  return queue_->description;
}

const std::string& ReadAhead::skipReason() const {
  return queue_->skip_reason;
}

SourceProgress ReadAhead::progress() const {
  const std::lock_guard lock(queue_->mutex);
  SourceProgress progress = queue_->progress;
  progress.dropped += queue_->dropped;
  return progress;
}

ReadStatus ReadAhead::read(RgbdFrame& frame) {
  Queue& queue = *queue_;
  std::unique_lock lock(queue.mutex);
  queue.changed.wait(lock, [&queue] { return queue.filled > 0; });
  Outcome& outcome = queue.ring[queue.first];
  if (outcome.error) std::rethrow_exception(outcome.error);  // stays in the queue for later reads
  if (outcome.status == ReadStatus::kEnd) return ReadStatus::kEnd;

  const ReadStatus status = outcome.status;
  std::swap(frame, outcome.frame);
  std::swap(queue.skip_reason, outcome.skip_reason);
  queue.first = (queue.first + 1) % queue.ring.size();
  --queue.filled;
  lock.unlock();
  queue.changed.notify_all();
  return status;
}

}  // namespace saccade
