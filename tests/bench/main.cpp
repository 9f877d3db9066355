#include <malloc.h>

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

int main(int argc, char** argv) {
  // A steady heap for ours and the rivals alike, as the program has: see apps/saccade/main.cpp.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
