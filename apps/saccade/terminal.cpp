#include "terminal.hpp"

#include <algorithm>
#include <csignal>
#include <iostream>
#include <unistd.h>

#include <fmt/format.h>

namespace saccade::app {
namespace {

constexpr int kBarWidth = 24;
constexpr auto kRedrawInterval = std::chrono::milliseconds(100);

volatile std::sig_atomic_t interrupt_asked = 0;

void onInterrupt(int signal) {
  interrupt_asked = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

bool talksToTerminal() {
  return ::isatty(STDERR_FILENO) != 0;
}

ProgressLine::ProgressLine(std::int64_t total) : total_(total) {}

ProgressLine::~ProgressLine() {
  clear();
}

void ProgressLine::show(std::int64_t done, const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  if (!talksToTerminal() || (now < next_ && done != total_)) return;
  next_ = now + kRedrawInterval;
  std::string line = "\r\x1b[K";
  if (total_ > 0) {
    const int filled = static_cast<int>(std::min(done, total_) * kBarWidth / total_);
    for (int i = 0; i < kBarWidth; ++i) line += i < filled ? "█" : "░";
    line += fmt::format(" {}/{}", done, total_);
  } else {
    line += std::to_string(done);
  }
  std::cerr << line << "  " << text << std::flush;
  shown_ = true;
}

void ProgressLine::clear() {
  if (shown_) std::cerr << "\r\x1b[K" << std::flush;
  shown_ = false;
}

std::string alignedTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string table;
  for (const auto& row : rows) {
    table += "  ";
    for (std::size_t i = 0; i < row.size(); ++i) {
      table += i == 0 ? fmt::format("{:<{}}", row[i], widths[i]) : fmt::format("  {:>{}}", row[i], widths[i]);
    }
    table.erase(table.find_last_not_of(' ') + 1);
    table += "\n";
  }
  return table;
}

std::string fixed(double value, int digits) {
  return fmt::format("{:.{}f}", value, digits);
}

std::string grouped(std::int64_t value) {
  std::string digits = std::to_string(value);
  const std::size_t first = value < 0 ? 1 : 0;
  for (std::size_t i = digits.size(); i > first + 3;) digits.insert(i -= 3, 1, ' ');
  return digits;
}

void catchInterrupts() {
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
}

bool interrupted() {
  return interrupt_asked != 0;
}

}  // namespace saccade::app
