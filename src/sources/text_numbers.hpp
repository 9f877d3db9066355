#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace saccade {

/// Splits a line at blanks, tabs, commas and carriage returns.
[[nodiscard]] inline std::vector<std::string_view> splitWords(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r\n,";
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = line.find_first_of(kBlanks, at);
    words.push_back(line.substr(at, end == std::string_view::npos ? end : end - at));
    at = line.find_first_not_of(kBlanks, end == std::string_view::npos ? line.size() : end);
  }
  return words;
}

/// The number that a whole word spells, whatever the locale; accepts "nan" and "inf", the caller checks.
[[nodiscard]] inline std::optional<double> parseNumber(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The text between double quotes, for messages.
[[nodiscard]] inline std::string inQuotes(std::string_view text) {
  std::string result(1, '"');
  result.append(text);
  result.push_back('"');
  return result;
}

}  // namespace saccade
