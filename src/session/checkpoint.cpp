#include "session/checkpoint.hpp"

#include <utility>

#if defined(__linux__)
#include <sched.h>
#include <sys/resource.h>
#endif

namespace saccade {
namespace {

/// The calling thread takes only what time is left. Not for good: whoever is no administrator cannot go back.
void becomeIdle() {
#if defined(__linux__)
  const sched_param none{};
  sched_setscheduler(0, SCHED_IDLE, &none);  // of the calling thread alone, on Linux
#endif
}

/// Threads that work on frames still go before the calling one.
void stepBack() {
#if defined(__linux__)
  constexpr int kNiceness = 10;             // a tenth of a processor is left to it in the worst case
  setpriority(PRIO_PROCESS, 0, kNiceness);  // of the calling thread alone, on Linux
#endif
}

/// Steps take some milliseconds where there is a processor for them.
constexpr std::chrono::milliseconds kLongStep{500};

}  // namespace

void Checkpoint::clear() {
  frames.clear();
  metrics.clear();
  candidates.clear();
  keyframes.clear();
  map.clear();
  state.clear();
}

/// A checkpoint on its way into the session; then its memory's into the state in which the next one wants it.
class CheckpointThread::Job {
 public:
  /// Of a checkpoint that is to be written, or only to be made room in.
  Job(std::unique_ptr<Checkpoint> checkpoint, bool is_to_be_written)
      : checkpoint_(std::move(checkpoint)), stage_(is_to_be_written ? Stage::kItems : Stage::kDurable) {}

  /// Does a little; whether there is more to do.
  [[nodiscard]] bool step(SessionWriter& writer) {
    switch (stage_) {
      case Stage::kItems:
        if (put(writer)) return true;
        writer.commit(checkpoint_->metadata);
        stage_ = Stage::kDurable;
        return true;
      case Stage::kDurable:
        checkpoint_->map.beginRoom();
        stage_ = Stage::kRoom;
        return true;
      case Stage::kRoom:
        return checkpoint_->map.touchMore();
    }
    return false;
  }
  /// Puts the next item, or all of the state; false if there was nothing left.
  bool put(SessionWriter& writer) {
    if (putNext(writer)) return true;
    for (const auto& [name, bytes] : std::exchange(checkpoint_->state, {})) writer.putState(name, bytes);
    return false;
  }
  [[nodiscard]] bool isDurable() const { return stage_ != Stage::kItems; }
  [[nodiscard]] std::unique_ptr<Checkpoint> release() { return std::move(checkpoint_); }

 private:
  enum class Stage { kItems, kDurable, kRoom };

  /// Puts the next item; false if there is none.
  bool putNext(SessionWriter& writer) {
    const Checkpoint& c = *checkpoint_;
    std::size_t i = next_++;
    const auto isOneOf = [&](const auto& items, const auto& put) {
      if (i < items.size()) {
        put(items[i]);
        return true;
      }
      i -= items.size();
      return false;
    };
    return isOneOf(c.frames, [&](const FrameRecord& frame) { writer.addFrame(frame); }) ||
           isOneOf(c.metrics, [&](const MetricsRecord& metrics) { writer.addMetrics(metrics); }) ||
           isOneOf(c.candidates, [&](const CandidateRecord& candidate) { writer.addCandidate(candidate); }) ||
           isOneOf(c.keyframes, [&](const KeyframeRecord& keyframe) { writer.addKeyframe(keyframe); }) ||
           isOneOf(c.map.removedTiles(), [&](std::uint64_t key) { writer.removeBlob(BlobTable::kTiles, key); }) ||
           isOneOf(c.map.parts(), [&](const MapSnapshot::Part& part) {
             writer.putBlob(part.table, {part.key, part.items, std::string(c.map.bytesOf(part))});
           });
  }

  std::unique_ptr<Checkpoint> checkpoint_;
  Stage stage_;
  std::size_t next_ = 0;
};

CheckpointThread::CheckpointThread(std::unique_ptr<SessionWriter> writer)
    : writer_(std::move(writer)),
      job_(std::make_unique<Job>(std::make_unique<Checkpoint>(), false)),
      begun_(Clock::now()),
      idle_thread_([this] { work(Standing::kIdle); }),
      ordinary_thread_([this] { work(Standing::kOrdinary); }) {}

CheckpointThread::~CheckpointThread() {
  end();
}

void CheckpointThread::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = is_urgent_ = true;
  }
  changed_.notify_all();
  for (std::thread* thread : {&idle_thread_, &ordinary_thread_}) {
    if (thread->joinable()) thread->join();
  }
}

bool CheckpointThread::idle() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  return job_ == nullptr;
}

void CheckpointThread::waitUntilIdle() {
  std::unique_lock lock(mutex_);
  is_urgent_ = true;
  changed_.notify_all();
  changed_.wait(lock, [&] { return job_ == nullptr; });
}

void CheckpointThread::lendRoom(MapSnapshot& map) {
  const std::lock_guard lock(mutex_);
  map.takeRoomOf(spare_->map);
}

void CheckpointThread::limitSize(std::uint64_t bytes) {
  waitUntilIdle();
  writer_->limitSize(bytes);
  loseHope();  // what comes next is known by what came last: checkpoints must not grow meanwhile
}

bool CheckpointThread::full() {
  const std::lock_guard lock(mutex_);
  return full_;
}

void CheckpointThread::write(std::unique_ptr<Checkpoint>& checkpoint) {
  {
    const std::lock_guard lock(mutex_);
    job_ = std::make_unique<Job>(std::move(checkpoint), true);
    checkpoint = std::move(spare_);
    begun_ = Clock::now();
    is_urgent_ = false;
  }
  changed_.notify_all();
  checkpoint->clear();
}

void CheckpointThread::finish(std::unique_ptr<Checkpoint> checkpoint) {
  waitUntilIdle();
  end();
  if (failure_) std::rethrow_exception(failure_);
  const SessionMetadata metadata = checkpoint->metadata;
  Job last(std::move(checkpoint), true);
  while (last.put(*writer_)) {
  }
  writer_->finish(metadata);
}

/// Waits for a job that is for a thread of this standing, or for the end.
void CheckpointThread::waitForWork(std::unique_lock<std::mutex>& lock, Standing standing) {
  while (!ending_ || job_ != nullptr) {
    const bool has_patience = patience_ > Clock::duration::zero();
    const bool is_mine = standing == Standing::kIdle ? has_patience : is_urgent_ || Clock::now() - begun_ >= patience_;
    if (job_ != nullptr && is_mine) return;
    if (job_ != nullptr && standing == Standing::kOrdinary) {
      changed_.wait_until(lock, begun_ + patience_);
    } else {
      changed_.wait(lock);
    }
  }
}

void CheckpointThread::work(Standing standing) {
  standing == Standing::kIdle ? becomeIdle() : stepBack();
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      waitForWork(lock, standing);
      if (job_ == nullptr) return;
    }
    const Clock::time_point asked = Clock::now();
    const std::lock_guard step(step_mutex_);
    if (standing == Standing::kOrdinary && Clock::now() - asked > kLongStep) loseHope();
    doStep();
  }
}

/// A step of the other thread that lasts so long shows a machine that leaves it no time: it is not asked again.
void CheckpointThread::loseHope() {
  const std::lock_guard lock(mutex_);
  patience_ = {};
}

/// One step of the job, unless the other thread has ended it meanwhile.
void CheckpointThread::doStep() {
  Job* job = nullptr;
  {
    const std::lock_guard lock(mutex_);
    job = job_.get();
  }
  if (job == nullptr) return;
  bool is_over = false;
  std::exception_ptr failure;
  try {
    is_over = !job->step(*writer_);
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  // Whoever waits for it to be durable does not wait for room as well.
  if (!is_over && !failure && !(is_urgent_ && job->isDurable())) return;
  failure_ = failure;
  full_ = writer_->full();
  spare_ = job_->release();
  job_.reset();
  changed_.notify_all();
}

}  // namespace saccade
