#pragma once

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

/// Writes checkpoints on a thread of its own, one at a time, at low priority: a frame is more urgent.
class CheckpointThread {
 public:
  explicit CheckpointThread(std::unique_ptr<SessionWriter> writer);
  /// Waits for the checkpoint in work; the session then is as it left it.
  ~CheckpointThread();
  CheckpointThread(const CheckpointThread&) = delete;
  CheckpointThread& operator=(const CheckpointThread&) = delete;

  /// Whether the last checkpoint is durable and the next one can be written. Throws what writing it threw.
  [[nodiscard]] bool idle();
  /// Lets `map` go on in memory that this thread has touched, which takes long. Only when idle().
  void lendRoom(MapSnapshot& map);
  void waitUntilIdle();
  /// As SessionWriter::limitSize(), and full() as of the last checkpoint that is durable.
  void limitSize(std::uint64_t bytes);
  [[nodiscard]] bool full();
  /// Takes what `checkpoint` holds and leaves an empty one to be filled. Only when idle().
  void write(std::unique_ptr<Checkpoint>& checkpoint);
  /// Waits, then writes the last checkpoint and ends the session. Throws what either threw.
  void finish(const Checkpoint& checkpoint);

 private:
  void work();
  void put(const Checkpoint& checkpoint);

  std::unique_ptr<SessionWriter> writer_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<Checkpoint> spare_;    // to be handed out
  std::unique_ptr<Checkpoint> in_work_;  // null: none
  bool is_ready_ = false;                // spare_ has room
  bool ending_ = false;
  bool full_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace saccade
