#!/bin/sh
# Builds the benchmarks, runs each stage beside its rivals and writes the results.
#   tests/bench/run.sh [RESULTS.json] [BENCHMARK OPTION...]
# RESULTS.json (bench.json where it is called) gets every figure, RESULTS.svg the cost of a frame by the size of the
# map; the table of README.md is written anew. Maps of 10^8 leaves want 10 GB of free memory and are skipped without.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${SACCADE_BUILD_DIR:-$root/build-bench}
json=${1:-bench.json}
[ $# -gt 0 ] && shift
"$root/apps/install-packages.sh" $(grep -v '^#' "$root/apps/packages.txt") libbenchmark-dev libpcl-dev
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSACCADE_BUILD_BENCHMARKS=ON >&2
cmake --build "$build" --target saccade_bench >&2
commit=$(git -C "$root" rev-parse --short HEAD 2> /dev/null || echo "not named")
git -C "$root" diff --quiet HEAD 2> /dev/null || commit="$commit with changes"
exec "$build/tests/bench/saccade_bench" --benchmark_out="$json" --benchmark_out_format=json \
  --table="$root/README.md" --commit="$commit" --scale-plot="${json%.json}.svg" "$@"
