#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace saccade {

/// Closed range of the values a number may take.
struct ValueRange {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
};

/// Visits the fields of a configuration struct in their order of declaration.
///
/// Each `Config` declares every field once, in a member
/// `void describe(ConfigVisitor& visitor) { visitor.number("theta", theta, {0, 1}, "", "share of ..."); }`,
/// and from this one declaration come parsing, validation, `--print-config`, `--help` and the record in the session.
class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;

  virtual void beginSection(std::string_view name, std::string_view help) = 0;
  virtual void endSection() = 0;
  /// `unit` is the field's unit ("m", "px", "ticks") or empty for a pure number.
  virtual void number(std::string_view name, double& value, ValueRange range, std::string_view unit,
                      std::string_view help) = 0;
  virtual void integer(std::string_view name, int& value, ValueRange range, std::string_view unit,
                       std::string_view help) = 0;
  virtual void flag(std::string_view name, bool& value, std::string_view help) = 0;
  /// A text; if `choices` is not empty the value must be one of them.
  virtual void text(std::string_view name, std::string& value, const std::vector<std::string>& choices,
                    std::string_view help) = 0;
  virtual void numbers(std::string_view name, std::vector<double>& values, ValueRange range, std::string_view unit,
                       std::string_view help) = 0;

  /// Visits `config` as the section `name` of the surrounding struct.
  template <typename Config>
  void section(std::string_view name, Config& config, std::string_view help) {
    beginSection(name, help);
    config.describe(*this);
    endSection();
  }
};

/// Throws std::invalid_argument that lists every field of `config` outside its range or choices, with name, value and
/// range; returns normally if all are good. For constructors.
template <typename Config>
void requireValid(const Config& config);

/// Non-template part of requireValid: collects complaints, one sentence each.
class ConfigChecker final : public ConfigVisitor {
 public:
  void beginSection(std::string_view name, std::string_view help) override;
  void endSection() override;
  void number(std::string_view name, double& value, ValueRange range, std::string_view unit,
              std::string_view help) override;
  void integer(std::string_view name, int& value, ValueRange range, std::string_view unit,
               std::string_view help) override;
  void flag(std::string_view name, bool& value, std::string_view help) override;
  void text(std::string_view name, std::string& value, const std::vector<std::string>& choices,
            std::string_view help) override;
  void numbers(std::string_view name, std::vector<double>& values, ValueRange range, std::string_view unit,
               std::string_view help) override;

  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }
  /// Throws std::invalid_argument with all complaints, if there are any.
  void throwIfAny() const;

 private:
  void check(std::string_view name, double value, ValueRange range, std::string_view unit);
  [[nodiscard]] std::string fullName(std::string_view name) const;

  std::vector<std::string> path_;
  std::vector<std::string> complaints_;
};

template <typename Config>
void requireValid(const Config& config) {
  Config copy = config;  // visitors may write; the checker does not, but takes references
  ConfigChecker checker;
  copy.describe(checker);
  checker.throwIfAny();
}

}  // namespace saccade
