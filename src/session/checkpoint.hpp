#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "saccade/session/session_records.hpp"
#include "saccade/session/session_writer.hpp"
#include "session/map_snapshot.hpp"

namespace saccade {

/// All that a session learns in one transaction.
struct Checkpoint {
  std::vector<FrameRecord> frames;
  std::vector<MetricsRecord> metrics;
  std::vector<CandidateRecord> candidates;
  std::vector<KeyframeRecord> keyframes;
  MapSnapshot map;
  std::map<std::string, std::string> state;
  SessionMetadata metadata;

  void clear();
};

/// Writes checkpoints beside the exploration, one at a time, step by step.
///
/// A thread that gets nothing but the time that nobody else wants does it all where there is enough of that: threads
/// that work on frames are never moved aside for it. What takes longer than a while, or is waited for, a second thread
/// of ordinary standing goes on with.
class CheckpointThread {
 public:
  explicit CheckpointThread(std::unique_ptr<SessionWriter> writer);
  /// Waits for the checkpoint in work; the session then is as it left it.
  ~CheckpointThread();
  CheckpointThread(const CheckpointThread&) = delete;
  CheckpointThread& operator=(const CheckpointThread&) = delete;

  /// Whether the last checkpoint is durable and the next one can be written. Throws what writing it threw.
  [[nodiscard]] bool idle();
  void waitUntilIdle();
  /// Lets `map` go on in memory that was touched here, which takes long. Only when idle().
  void lendRoom(MapSnapshot& map);
  /// As SessionWriter::limitSize(), and full() as of the last checkpoint that is durable.
  void limitSize(std::uint64_t bytes);
  [[nodiscard]] bool full();
  /// Takes what `checkpoint` holds and leaves an empty one to be filled. Only when idle().
  void write(std::unique_ptr<Checkpoint>& checkpoint);
  /// Waits, then writes the last checkpoint and ends the session. Throws what either threw.
  void finish(std::unique_ptr<Checkpoint> checkpoint);

 private:
  using Clock = std::chrono::steady_clock;
  class Job;
  enum class Standing { kIdle, kOrdinary };

  void work(Standing standing);
  void waitForWork(std::unique_lock<std::mutex>& lock, Standing standing);
  void doStep();
  void loseHope();
  void end();

  std::unique_ptr<SessionWriter> writer_;
  std::mutex step_mutex_;  // held for a step of the job; before mutex_
  std::mutex mutex_;       // of all below
  std::condition_variable changed_;
  std::unique_ptr<Checkpoint> spare_;  // to be handed out; null while a job is in work
  std::unique_ptr<Job> job_;           // null: idle
  Clock::time_point begun_;
  // So long a job may take that gets only what time is left; zero: none is, or none is to be waited for.
  Clock::duration patience_ = std::chrono::seconds(1);
  bool is_urgent_ = false;
  bool ending_ = false;
  bool full_ = false;
  std::exception_ptr failure_;
  std::thread idle_thread_, ordinary_thread_;
};

}  // namespace saccade
