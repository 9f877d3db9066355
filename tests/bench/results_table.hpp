#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/scale_plot.hpp"

namespace saccade::bench {

/// Prints results to the console as they come, and keeps each benchmark's CPU time, by name, for a table.
class ResultsTable : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override;

  /// The table in Markdown: each stage beside its rivals, with the ratio, and what it was measured on.
  [[nodiscard]] std::string markdown(const std::string& commit) const;
  /// What the stages cost by the size of the map; empty lines if that was not measured.
  [[nodiscard]] std::vector<ScaleLine> scale() const;

 private:
  /// A benchmark of what one would take instead, and how many times it would have to run for the same work.
  struct Rival {
    std::string name, label;
    double times = 1.0;
  };
  struct Result {
    double time_ms = 0.0;
    std::map<std::string, double> counters;
  };

  [[nodiscard]] std::string row(const std::string& stage, const std::vector<std::string>& ours,
                                const std::vector<Rival>& rivals) const;
  [[nodiscard]] std::string scaleRow() const;
  [[nodiscard]] double timeOf(const std::string& name) const;

  std::map<std::string, Result> results_;
};

/// Replaces what stands between the lines `<!-- bench -->` and `<!-- /bench -->` of a file. Throws std::runtime_error
/// if the file cannot be read or written or has no such lines.
void replaceTable(const std::filesystem::path& path, const std::string& table);

}  // namespace saccade::bench
