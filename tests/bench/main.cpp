// Options beside those of Google Benchmark: --table=FILE writes the table of results into FILE, between its markers;
// --commit=NAME says in it what was measured; --scale-plot=FILE.svg draws cost over the size of the map.

#include <cstring>
#include <exception>
#include <iostream>
#include <malloc.h>
#include <string>

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

#include "bench/results_table.hpp"

namespace {

/// Takes `--name=VALUE` out of the arguments; "" if it is not there.
std::string takeOption(int& argc, char** argv, const std::string& name) {
  const std::string start = "--" + name + "=";
  std::string value;
  int kept = 0;
  for (int i = 0; i < argc; ++i) {
    if (std::strncmp(argv[i], start.c_str(), start.size()) == 0) {
      value = argv[i] + start.size();
    } else {
      argv[kept++] = argv[i];
    }
  }
  argc = kept;
  return value;
}

}  // namespace

int main(int argc, char** argv) {
  // A steady heap for ours and the rivals alike, as the program has: see apps/saccade/main.cpp.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  cv::setNumThreads(1);
  const std::string table = takeOption(argc, argv, "table"), commit = takeOption(argc, argv, "commit"),
                    plot = takeOption(argc, argv, "scale-plot");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  saccade::bench::ResultsTable results;
  benchmark::RunSpecifiedBenchmarks(&results);
  if (table.empty()) return 0;
  try {
    saccade::bench::replaceTable(table, results.markdown(commit.empty() ? "not named" : commit));
    if (!plot.empty()) saccade::bench::writeScalePlot(plot, results.scale());
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
