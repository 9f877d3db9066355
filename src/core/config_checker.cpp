#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "saccade/core/config_fields.hpp"

namespace saccade {

void ConfigChecker::beginSection(std::string_view name, std::string_view /*help*/) {
  path_.emplace_back(name);
}

void ConfigChecker::endSection() {
  path_.pop_back();
}

void ConfigChecker::number(std::string_view name, double& value, ValueRange range, std::string_view unit,
                           std::string_view /*help*/) {
  check(name, value, range, unit);
}

void ConfigChecker::integer(std::string_view name, int& value, ValueRange range, std::string_view unit,
                            std::string_view /*help*/) {
  check(name, value, range, unit);
}

void ConfigChecker::flag(std::string_view /*name*/, bool& /*value*/, std::string_view /*help*/) {}

void ConfigChecker::text(std::string_view name, std::string& value, const std::vector<std::string>& choices,
                         std::string_view /*help*/) {
  if (choices.empty() || std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  std::string expected;
  for (const std::string& choice : choices) expected += (expected.empty() ? "" : ", ") + choice;
  complaints_.push_back(fullName(name) + ": expected one of " + expected + ", found \"" + value + "\"");
}

void ConfigChecker::numbers(std::string_view name, std::vector<double>& values, ValueRange range, std::string_view unit,
                            std::string_view /*help*/) {
  for (const double value : values) check(name, value, range, unit);
}

void ConfigChecker::throwIfAny() const {
  if (complaints_.empty()) return;
  std::string all;
  for (const std::string& complaint : complaints_) all += (all.empty() ? "" : "; ") + complaint;
  throw std::invalid_argument(all);
}

void ConfigChecker::check(std::string_view name, double value, ValueRange range, std::string_view unit) {
  if (value >= range.lowest && value <= range.highest) return;  // false for NaN too
  std::ostringstream complaint;
  complaint << fullName(name) << ": expected " << range.lowest << " to " << range.highest << (unit.empty() ? "" : " ")
            << unit << ", found " << value;
  complaints_.push_back(complaint.str());
}

std::string ConfigChecker::fullName(std::string_view name) const {
  std::string full;
  for (const std::string& section : path_) full += section + ".";
  return full.append(name);
}

}  // namespace saccade
