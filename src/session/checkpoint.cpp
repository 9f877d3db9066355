#include "session/checkpoint.hpp"

#include <utility>

#if defined(__linux__)
#include <sys/resource.h>
#endif

namespace saccade {
namespace {

/// Lets threads that work on frames go first where processors are few. Only advice: without it all works, less
/// smoothly.
void stepBack() {
#if defined(__linux__)
  constexpr int kNiceness = 10;             // a tenth of a processor is left to it in the worst case
  setpriority(PRIO_PROCESS, 0, kNiceness);  // of the calling thread alone, on Linux
#endif
}

}  // namespace

void Checkpoint::clear() {
  frames.clear();
  metrics.clear();
  candidates.clear();
  keyframes.clear();
  map.clear();
  state.clear();
}

CheckpointThread::CheckpointThread(std::unique_ptr<SessionWriter> writer)
    : writer_(std::move(writer)), spare_(std::make_unique<Checkpoint>()), thread_([this] { work(); }) {}

CheckpointThread::~CheckpointThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool CheckpointThread::idle() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  return is_ready_ && in_work_ == nullptr;
}

void CheckpointThread::lendRoom(MapSnapshot& map) {
  const std::lock_guard lock(mutex_);
  map.takeRoomOf(spare_->map);
}

void CheckpointThread::waitUntilIdle() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return in_work_ == nullptr; });
}

void CheckpointThread::limitSize(std::uint64_t bytes) {
  waitUntilIdle();
  writer_->limitSize(bytes);
}

bool CheckpointThread::full() {
  const std::lock_guard lock(mutex_);
  return full_;
}

void CheckpointThread::write(std::unique_ptr<Checkpoint>& checkpoint) {
  {
    const std::lock_guard lock(mutex_);
    in_work_ = std::move(checkpoint);
    checkpoint = std::move(spare_);
  }
  checkpoint->clear();
  changed_.notify_all();
}

void CheckpointThread::finish(const Checkpoint& checkpoint) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return in_work_ == nullptr; });
    ending_ = true;
    if (failure_) std::rethrow_exception(failure_);
  }
  changed_.notify_all();
  thread_.join();
  put(checkpoint);
  writer_->finish(checkpoint.metadata);
}

void CheckpointThread::work() {
  stepBack();
  spare_->map.makeRoom();
  std::unique_lock lock(mutex_);
  is_ready_ = true;
  for (;;) {
    changed_.wait(lock, [&] { return ending_ || in_work_ != nullptr; });
    if (in_work_ == nullptr) return;
    lock.unlock();
    std::exception_ptr failure;
    try {
      put(*in_work_);
      writer_->commit(in_work_->metadata);
      in_work_->map.makeRoom();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    failure_ = failure;
    full_ = writer_->full();
    spare_ = std::move(in_work_);
    changed_.notify_all();
    if (failure_) return;
  }
}

void CheckpointThread::put(const Checkpoint& checkpoint) {
  for (const FrameRecord& frame : checkpoint.frames) writer_->addFrame(frame);
  for (const MetricsRecord& metrics : checkpoint.metrics) writer_->addMetrics(metrics);
  for (const CandidateRecord& candidate : checkpoint.candidates) writer_->addCandidate(candidate);
  for (const KeyframeRecord& keyframe : checkpoint.keyframes) writer_->addKeyframe(keyframe);
  for (const std::uint64_t key : checkpoint.map.removedTiles()) writer_->removeBlob(BlobTable::kTiles, key);
  for (const MapSnapshot::Part& part : checkpoint.map.parts()) {
    writer_->putBlob(part.table, {part.key, part.items, std::string(checkpoint.map.bytesOf(part))});
  }
  for (const auto& [name, bytes] : checkpoint.state) writer_->putState(name, bytes);
}

}  // namespace saccade
