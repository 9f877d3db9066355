#!/bin/sh
# Installs the Debian packages that are missing, then configures and builds Saccade.
#   apps/build.sh BUILD_DIR [cmake options] [-- ninja targets]
# Run again, it builds only what changed.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=${1:?apps/build.sh: expected a build folder, for example: apps/build.sh build}
shift

options=""
while [ $# -gt 0 ] && [ "$1" != "--" ]; do
  options="$options $1"
  shift
done
[ $# -gt 0 ] && shift

"$root/apps/install-packages.sh" $(grep -v '^#' "$root/apps/packages.txt")
# The page of `saccade view`. An npm from elsewhere would be at odds with Debian's.
command -v npm >/dev/null || "$root/apps/install-packages.sh" nodejs npm

if [ ! -f "$build/build.ninja" ] || [ -n "$options" ]; then
  cmake -S "$root" -B "$build" -G Ninja $options >"${TMPDIR:-/tmp}/saccade-cmake.$$" 2>&1 || {
    cat "${TMPDIR:-/tmp}/saccade-cmake.$$" >&2
    rm -f "${TMPDIR:-/tmp}/saccade-cmake.$$"
    exit 1
  }
  rm -f "${TMPDIR:-/tmp}/saccade-cmake.$$"
fi
cmake --build "$build" --parallel "$(nproc)" ${1:+--target "$@"}
