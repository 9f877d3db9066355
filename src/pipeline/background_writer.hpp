#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace saccade {

/// Writes jobs on a thread of its own, in the order in which they come, while the next ones are filled. Jobs are
/// recycled: there are two, and whoever is more than one ahead waits.
///
/// What `write` throws is thrown by the next call; nothing is written any more then.
template <typename Job>
class BackgroundWriter {
 public:
  explicit BackgroundWriter(std::function<void(const Job&)> write)
      : write_(std::move(write)), thread_([this] { work(); }) {}
  /// Writes what was submitted.
  ~BackgroundWriter() { join(); }
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  /// The job to fill next, as an earlier one left it; submit() is to follow.
  Job& next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return submitted_ - written_ < jobs_.size() || failure_; });
    if (failure_) std::rethrow_exception(failure_);
    return jobs_[submitted_ % jobs_.size()];
  }
  void submit() {
    {
      const std::lock_guard lock(mutex_);
      ++submitted_;
    }
    changed_.notify_all();
  }
  /// Waits until all is written; no job may follow.
  void finish() {
    join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void join() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return ending_ || written_ < submitted_; });
      if (written_ == submitted_) return;
      const Job& job = jobs_[written_ % jobs_.size()];
      lock.unlock();
      std::exception_ptr failure;
      try {
        write_(job);
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      failure_ = failure;
      ++written_;
      changed_.notify_all();
      if (failure_) return;
    }
  }

  std::function<void(const Job&)> write_;
  std::array<Job, 2> jobs_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t submitted_ = 0, written_ = 0;  // jobs so far
  bool ending_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace saccade
