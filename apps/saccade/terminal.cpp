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

/// Characters of UTF-8 text.
std::size_t lengthOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

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
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], lengthOf(row[i]));
  }
  std::string table;
  for (const auto& row : rows) {
    table += "  ";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string blanks(widths[i] - lengthOf(row[i]), ' ');
      table += i == 0 ? row[i] + blanks : "  " + blanks + row[i];
    }
    table.erase(table.find_last_not_of(' ') + 1);
    table += "\n";
  }
  return table;
}

std::string sparkline(const std::vector<double>& values, std::size_t width) {
  if (values.empty()) return "";
  const std::size_t count = std::min(width, values.size());
  std::vector<double> means(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * values.size() / count, end = (i + 1) * values.size() / count;
    for (std::size_t j = begin; j < end; ++j) means[i] += values[j] / static_cast<double>(end - begin);
  }
  const auto [least, most] = std::minmax_element(means.begin(), means.end());
  const double low = std::min(0.0, *least), range = *most - low;
  constexpr const char* kBlocks[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::string line;
  for (const double mean : means) line += kBlocks[range > 0.0 ? static_cast<int>((mean - low) / range * 7.0 + 0.5) : 0];
  return line;
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
