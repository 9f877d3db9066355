#include "sources/lasting_thread.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace saccade {

struct LastingThread::Worker {
  std::mutex mutex;
  std::condition_variable changed;
  const std::function<void()>* action = nullptr;

  [[noreturn]] void work() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return action != nullptr; });
      (*action)();
      action = nullptr;
      changed.notify_all();
    }
  }
};

/// The threads that nobody uses; like them it lasts until the program ends.
struct LastingThread::Idle {
  std::mutex mutex;
  std::vector<Worker*> workers;

  static Idle& instance() {
    static Idle* const idle = new Idle;
    return *idle;
  }
};

LastingThread::LastingThread() {
  Idle& idle = Idle::instance();
  const std::lock_guard lock(idle.mutex);
  if (idle.workers.empty()) {
    worker_ = new Worker;
    std::thread([worker = worker_] { worker->work(); }).detach();
    return;
  }
  worker_ = idle.workers.back();
  idle.workers.pop_back();
}

LastingThread::~LastingThread() {
  Idle& idle = Idle::instance();
  const std::lock_guard lock(idle.mutex);
  idle.workers.push_back(worker_);
}

void LastingThread::run(const std::function<void()>& action) {
  std::unique_lock lock(worker_->mutex);
  worker_->action = &action;
  worker_->changed.notify_all();
  worker_->changed.wait(lock, [this] { return worker_->action == nullptr; });
}

}  // namespace saccade
