#pragma once

#include <chrono>
#include <utility>
#include <vector>

#include "saccade/pipeline/frame_report.hpp"

namespace saccade {

/// Times the stages of one branch of one frame.
class StageClock {
 public:
  StageClock() : start_(Clock::now()) {}

  /// Runs `work`, notes how long it took under `stage` (a literal), and returns what it returns.
  template <typename Work>
  decltype(auto) time(const char* stage, Work&& work) {
    const Note note{this, stage, Clock::now()};
    return std::forward<Work>(work)();
  }

  /// Adds stages that ran elsewhere.
  void add(const std::vector<StageTime>& stages) { stages_.insert(stages_.end(), stages.begin(), stages.end()); }

  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }
  /// Milliseconds since the clock was made.
  [[nodiscard]] double total_ms() const { return milliseconds(Clock::now() - start_); }

 private:
  using Clock = std::chrono::steady_clock;

  static double milliseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
  }

  struct Note {
    StageClock* clock;
    const char* stage;
    Clock::time_point begin;
    ~Note() { clock->stages_.push_back({stage, milliseconds(Clock::now() - begin)}); }
  };

  Clock::time_point start_;
  std::vector<StageTime> stages_;
};

}  // namespace saccade
