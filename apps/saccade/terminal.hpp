#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace saccade::app {

/// Whether stderr is a terminal: progress bars and colours only go there.
[[nodiscard]] bool talksToTerminal();

/// One line on stderr that is rewritten in place; on something that is not a terminal it says nothing.
class ProgressLine {
 public:
  /// `total` < 0: the end is not known.
  explicit ProgressLine(std::int64_t total);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Shows `done` of the total with `text` behind the bar; redraws at most ten times a second.
  void show(std::int64_t done, const std::string& text);
  /// Removes the line, so that other text can be written.
  void clear();

 private:
  std::int64_t total_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

/// Rows of UTF-8 text in aligned columns; the first column to the left, the others to the right.
[[nodiscard]] std::string alignedTable(const std::vector<std::vector<std::string>>& rows);

/// The course of `values` as one line of at most `width` blocks of eight heights, from 0 (or their least, if that is
/// negative) to their largest; each block is the mean of an equal part of them.
[[nodiscard]] std::string sparkline(const std::vector<double>& values, std::size_t width = 40);

/// `value` with `digits` digits behind the point.
[[nodiscard]] std::string fixed(double value, int digits);

/// 1234567 as "1 234 567".
[[nodiscard]] std::string grouped(std::int64_t value);

/// Makes Ctrl-C (SIGINT) and SIGTERM ask for a clean end; a second one ends at once.
void catchInterrupts();
/// Whether a clean end was asked for.
[[nodiscard]] bool interrupted();

}  // namespace saccade::app
