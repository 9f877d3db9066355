#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <utility>

#include <tbb/task_group.h>

namespace saccade {

/// Work that the first idle thread of TBB begins; who needs it done does it himself if none has, and else only waits.
///
/// Waiting for a task_group is different: there the waiting thread takes whatever task it finds, and is away for as
/// long as that one takes, when what it waited for is long done.
class Errand {
 public:
  Errand() = default;
  ~Errand() {
    settle();
    group_.wait();  // for tasks that came too late: they find nothing to do
  }
  Errand(const Errand&) = delete;
  Errand& operator=(const Errand&) = delete;

  /// Has `work` done. What was offered before must be finished.
  void offer(std::function<void()> work) {
    work_ = std::move(work);
    error_ = nullptr;
    state_ = State::kOffered;
    group_.run([this] { attempt(); });
  }
  /// Does it, unless another thread has begun or there is nothing to do.
  void attempt() {
    State offered = State::kOffered;
    if (!state_.compare_exchange_strong(offered, State::kBegun)) return;
    try {
      work_();
    } catch (...) {
      error_ = std::current_exception();
    }
    state_ = State::kDone;
    state_.notify_all();
  }
  /// Whether nothing is offered or in work.
  [[nodiscard]] bool isDone() const {
    const State state = state_;
    return state == State::kNone || state == State::kDone;
  }
  /// Sees it done, and throws what it threw. For the thread that offered it.
  void finish() {
    settle();
    if (std::exception_ptr error = std::exchange(error_, nullptr)) std::rethrow_exception(error);
  }
  /// The same where nobody wants to know how it ended.
  void settle() {
    attempt();
    state_.wait(State::kBegun);
    state_ = State::kNone;
    work_ = nullptr;
  }

 private:
  enum class State { kNone, kOffered, kBegun, kDone };

  std::function<void()> work_;
  std::atomic<State> state_ = State::kNone;
  std::exception_ptr error_;
  tbb::task_group group_;
};

}  // namespace saccade
