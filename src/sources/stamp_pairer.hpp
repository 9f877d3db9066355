#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

namespace saccade {

/// Pairs two streams of stamped things as they come: each with the nearest of the other stream, as long as their stamps
/// differ by no more than 20 ms. What finds no partner is dropped and counted.
template <typename First, typename Second>
class StampPairer {
 public:
  void addFirst(double stamp_s, First first) { first_.emplace_back(stamp_s, std::move(first)); }
  void addSecond(double stamp_s, Second second) { second_.emplace_back(stamp_s, std::move(second)); }
  /// Nothing more will come.
  void end() { ended_ = true; }

  struct Pair {
    double first_stamp_s, second_stamp_s;
    First first;
    Second second;
  };
  /// The next pair; none until more has been added, or ever, after end().
  [[nodiscard]] std::optional<Pair> next() {
    while (!first_.empty() && !second_.empty()) {
      const double difference = first_.front().first - second_.front().first;
      if (std::abs(difference) > kMaxDifference_s) {
        dropFront(difference < 0);
        continue;
      }
      if (std::abs(difference) > kSureDifference_s) {
        // The follower of the earlier one may be nearer.
        const std::optional<double> follower = difference < 0 ? stampAfter(first_) : stampAfter(second_);
        if (!follower && !ended_) return std::nullopt;
        const double other = difference < 0 ? second_.front().first : first_.front().first;
        if (follower && std::abs(*follower - other) < std::abs(difference)) {
          dropFront(difference < 0);
          continue;
        }
      }
      Pair pair{first_.front().first, second_.front().first, std::move(first_.front().second),
                std::move(second_.front().second)};
      first_.pop_front();
      second_.pop_front();
      return pair;
    }
    if (ended_) {
      dropped_first_ += static_cast<std::int64_t>(first_.size());
      dropped_second_ += static_cast<std::int64_t>(second_.size());
      first_.clear();
      second_.clear();
    }
    return std::nullopt;
  }

  /// Those that found no partner so far: of both streams, and of the first.
  [[nodiscard]] std::int64_t dropped() const { return dropped_first_ + dropped_second_; }
  [[nodiscard]] std::int64_t droppedFirst() const { return dropped_first_; }

 private:
  static constexpr double kMaxDifference_s = 0.02;
  static constexpr double kSureDifference_s = 0.008;  // at up to 60 frames a second no other can be nearer

  template <typename T>
  static std::optional<double> stampAfter(const std::deque<std::pair<double, T>>& stream) {
    return stream.size() > 1 ? std::optional(stream[1].first) : std::nullopt;
  }
  void dropFront(bool of_first) {
    of_first ? first_.pop_front() : second_.pop_front();
    ++(of_first ? dropped_first_ : dropped_second_);
  }

  std::deque<std::pair<double, First>> first_;
  std::deque<std::pair<double, Second>> second_;
  bool ended_ = false;
  std::int64_t dropped_first_ = 0, dropped_second_ = 0;
};

}  // namespace saccade
