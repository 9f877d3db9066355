#include "saccade/core/config_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

/// Shortest decimal text that reads back as the same number.
std::string shortest(double value) {
  char buffer[32];
  const auto [end, error] = std::to_chars(std::begin(buffer), std::end(buffer), value);
  return error == std::errc() ? std::string(buffer, end) : std::to_string(value);
}

class YamlReader final : public ConfigVisitor {
 public:
  explicit YamlReader(const YAML::Node& root) { levels_.push_back({"", root, {}}); }

  void beginSection(std::string_view name, std::string_view /*help*/) override {
    YAML::Node section = take(name);
    if (section.IsDefined() && !section.IsNull() && !section.IsMap()) {
      complain(name, "a section with keys", "\"" + YAML::Dump(section) + "\"");
      section.reset();
    }
    levels_.push_back({std::string(name), section, {}});
  }

  void endSection() override {
    complainAboutUnknownKeys();
    levels_.pop_back();
  }

  void number(std::string_view name, double& value, ValueRange /*range*/, std::string_view /*unit*/,
              std::string_view /*help*/) override {
    read(name, value, "a number");
  }
  void integer(std::string_view name, int& value, ValueRange /*range*/, std::string_view /*unit*/,
               std::string_view /*help*/) override {
    read(name, value, "a whole number");
  }
  void flag(std::string_view name, bool& value, std::string_view /*help*/) override {
    read(name, value, "true or false");
  }
  void text(std::string_view name, std::string& value, const std::vector<std::string>& /*choices*/,
            std::string_view /*help*/) override {
    read(name, value, "a text");
  }
  void numbers(std::string_view name, std::vector<double>& values, ValueRange /*range*/, std::string_view /*unit*/,
               std::string_view /*help*/) override {
    read(name, values, "a list of numbers");
  }

  /// Call once after describe().
  void finish() { complainAboutUnknownKeys(); }
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  struct Level {
    std::string name;
    YAML::Node node;
    std::set<std::string> known;
  };

  YAML::Node take(std::string_view name) {
    Level& level = levels_.back();
    level.known.emplace(name);
    if (!level.node.IsDefined() || !level.node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
    return level.node[std::string(name)];
  }

  template <typename Value>
  void read(std::string_view name, Value& value, const std::string& expected) {
    const YAML::Node node = take(name);
    if (!node.IsDefined()) return;
    try {
      value = node.as<Value>();
    } catch (const YAML::Exception&) {
      complain(name, expected, "\"" + YAML::Dump(node) + "\"");
    }
  }

  void complainAboutUnknownKeys() {
    const Level& level = levels_.back();
    if (!level.node.IsDefined() || !level.node.IsMap()) return;
    for (const auto& entry : level.node) {
      const auto key = entry.first.as<std::string>("?");
      if (level.known.count(key) != 0) continue;
      std::string known;
      for (const std::string& name : level.known) known += (known.empty() ? "" : ", ") + name;
      complain(key, "one of the keys " + known, "an unknown key");
    }
  }

  void complain(std::string_view name, const std::string& expected, const std::string& found) {
    std::string full;
    for (const Level& level : levels_)
      if (!level.name.empty()) full += level.name + ".";
    complaints_.push_back(full.append(name) + ": expected " + expected + ", found " + found);
  }

  std::vector<Level> levels_;
  std::vector<std::string> complaints_;
};

class YamlPrinter final : public ConfigVisitor {
 public:
  explicit YamlPrinter(bool explain) : explain_(explain) {}

  void beginSection(std::string_view name, std::string_view help) override {
    indent() << name << ":";
    if (explain_) out_ << "  # " << help;
    out_ << "\n";
    ++depth_;
  }
  void endSection() override { --depth_; }
  void number(std::string_view name, double& value, ValueRange range, std::string_view unit,
              std::string_view help) override {
    line(name, shortest(value), unit, help, rangeText(range));
  }
  void integer(std::string_view name, int& value, ValueRange range, std::string_view unit,
               std::string_view help) override {
    line(name, std::to_string(value), unit, help, rangeText(range));
  }
  void flag(std::string_view name, bool& value, std::string_view help) override {
    line(name, value ? "true" : "false", "", help, "");
  }
  void text(std::string_view name, std::string& value, const std::vector<std::string>& choices,
            std::string_view help) override {
    std::string all;
    for (const std::string& choice : choices) all += (all.empty() ? "" : " | ") + choice;
    YAML::Emitter quoted;
    quoted << YAML::DoubleQuoted << value;
    line(name, quoted.c_str(), "", help, all);
  }
  void numbers(std::string_view name, std::vector<double>& values, ValueRange range, std::string_view unit,
               std::string_view help) override {
    std::string list;
    for (const double value : values) list += (list.empty() ? "" : ", ") + shortest(value);
    line(name, "[" + list + "]", unit, help, rangeText(range));
  }

  [[nodiscard]] std::string text() const { return out_.str(); }

 private:
  std::ostream& indent() { return out_ << std::string(2 * depth_, ' '); }

  static std::string rangeText(ValueRange range) {
    if (std::isinf(range.lowest) && std::isinf(range.highest)) return "";
    if (std::isinf(range.highest)) return "at least " + shortest(range.lowest);
    return shortest(range.lowest) + " to " + shortest(range.highest);
  }

  void line(std::string_view name, const std::string& value, std::string_view unit, std::string_view help,
            const std::string& allowed) {
    indent() << name << ": " << value;
    if (explain_) {
      out_ << "  # " << help;
      if (!unit.empty()) out_ << ", " << unit;
      if (!allowed.empty()) out_ << " (" << allowed << ")";
    }
    out_ << "\n";
  }

  bool explain_;
  std::size_t depth_ = 0;
  std::ostringstream out_;
};

std::string joined(const std::vector<std::string>& complaints) {
  std::string all;
  for (const std::string& complaint : complaints) all += (all.empty() ? "" : "; ") + complaint;
  return all;
}

std::vector<std::string> applyNode(const YAML::Node& root, const DescribeConfig& describe) {
  YamlReader reader(root);
  describe(reader);
  reader.finish();
  ConfigChecker checker;
  describe(checker);
  std::vector<std::string> complaints = reader.complaints();
  complaints.insert(complaints.end(), checker.complaints().begin(), checker.complaints().end());
  return complaints;
}

}  // namespace

void applyConfigText(const std::string& yaml, const std::filesystem::path& origin, const DescribeConfig& describe) {
  YAML::Node root;
  try {
    root = YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw IoError(origin, "a YAML configuration", error.what());
  }
  if (root.IsNull()) return;
  if (!root.IsMap()) throw IoError(origin, "YAML sections with keys", "something else");
  const std::vector<std::string> complaints = applyNode(root, describe);
  if (!complaints.empty()) throw IoError(origin, "a valid configuration (see --print-config)", joined(complaints));
}

void applyConfigFile(const std::filesystem::path& path, const DescribeConfig& describe) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw IoError(path, "a readable, non-empty configuration file", "none");
  }
  applyConfigText(text.str(), path, describe);
}

void applyConfigSettings(const std::vector<std::string>& settings, const DescribeConfig& describe) {
  std::vector<std::string> complaints;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      complaints.push_back("--set " + setting + ": expected section.key=value, found no '='");
      continue;
    }
    YAML::Node leaf;
    try {
      leaf = YAML::Load(setting.substr(equals + 1));
    } catch (const YAML::Exception&) {
      complaints.push_back("--set " + setting + ": expected a value after '=', found something unreadable");
      continue;
    }
    std::string keys = setting.substr(0, equals);
    while (true) {
      const std::size_t dot = keys.rfind('.');
      YAML::Node outer;
      outer[dot == std::string::npos ? keys : keys.substr(dot + 1)] = leaf;
      leaf = outer;
      if (dot == std::string::npos) break;
      keys.resize(dot);
    }
    for (const std::string& complaint : applyNode(leaf, describe)) complaints.push_back(complaint);
  }
  if (!complaints.empty()) throw std::invalid_argument(joined(complaints));
}

std::string printConfig(const DescribeConfig& describe, bool explain) {
  YamlPrinter printer(explain);
  describe(printer);
  return printer.text();
}

}  // namespace saccade
