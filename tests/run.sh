#!/bin/sh
# Builds Saccade and runs its tests; installs what a bare Debian 12 lacks.
#   tests/run.sh              unit and system tests
#   tests/run.sh --sanitize   the same again under address and undefined-behaviour sanitizers
#   tests/run.sh --slow       also the long sequences, the sanitizers, and a minute of each fuzzer
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=${SACCADE_BUILD_DIR:-$root/build}
slow=no
sanitize=no
for argument in "$@"; do
  case $argument in
    --slow) slow=yes sanitize=yes ;;
    --sanitize) sanitize=yes ;;
    *) echo "tests/run.sh: unknown option $argument (expected --sanitize or --slow)" >&2; exit 2 ;;
  esac
done

"$root/apps/install-packages.sh" $(grep -v '^#' "$root/tests/packages.txt")
"$root/apps/build.sh" "$build" -DCMAKE_BUILD_TYPE=Release -DSACCADE_BUILD_TESTS=ON -DSACCADE_WERROR=ON
if [ $sanitize = yes ]; then
  "$root/apps/build.sh" "$build-sanitize" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DSACCADE_BUILD_TESTS=ON \
    -DSACCADE_SANITIZE=address,undefined
  (cd "$build-sanitize" && ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 \
    ctest --output-on-failure --parallel "$(nproc)" --label-exclude slow)
fi
if [ $slow = yes ]; then
  "$root/apps/install-packages.sh" clang
  CC=clang CXX=clang++ "$root/apps/build.sh" "$build-fuzz" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DSACCADE_BUILD_TESTS=OFF \
    -DSACCADE_BUILD_FUZZERS=ON -DSACCADE_SANITIZE=address,undefined
  for target in candidate_lines config dataset_lists octomap session; do
    seeds=$root/tests/fuzz/corpus/$target
    [ $target = session ] && seeds=$root/maps
    found=$build-fuzz/found/$target
    mkdir -p "$found"
    "$build-fuzz/tests/fuzz/${target}_fuzzer" -max_total_time=60 -timeout=20 -rss_limit_mb=2048 -max_len=4194304 \
      -artifact_prefix="$found/" "$found" "$seeds"
  done
fi
cd "$build"
[ $slow = yes ] && exec ctest --output-on-failure --parallel "$(nproc)"
exec ctest --output-on-failure --parallel "$(nproc)" --label-exclude slow
