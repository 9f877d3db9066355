#pragma once

#include <functional>

namespace saccade {

/// A thread that never ends: who is done with it leaves it to the next who needs one.
///
/// OpenNI2 remembers every thread that ever waited for a frame and asks whether it still lives, which it may not once
/// the thread is gone (pthread_kill on a thread that was joined ends the program). So all waiting is done on such
/// threads.
class LastingThread {
 public:
  LastingThread();
  ~LastingThread();
  LastingThread(const LastingThread&) = delete;
  LastingThread& operator=(const LastingThread&) = delete;

  /// Runs `action`, which may not throw, on the thread and waits for its end. For one caller at a time.
  void run(const std::function<void()>& action);

 private:
  struct Worker;
  struct Idle;
  Worker* worker_;
};

}  // namespace saccade
