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

missing=""
for package in $(grep -v '^#' "$root/apps/packages.txt"); do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed' || missing="$missing $package"
done
if [ -n "$missing" ]; then
  as_root=""
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Saccade needs these Debian packages, and sudo is not here to install them:$missing" >&2; exit 1; }
    as_root=sudo
  fi
  echo "Installing Debian packages:$missing" >&2
  $as_root apt-get update -qq
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
fi

if [ ! -f "$build/build.ninja" ] || [ -n "$options" ]; then
  cmake -S "$root" -B "$build" -G Ninja $options >"${TMPDIR:-/tmp}/saccade-cmake.$$" 2>&1 || {
    cat "${TMPDIR:-/tmp}/saccade-cmake.$$" >&2
    rm -f "${TMPDIR:-/tmp}/saccade-cmake.$$"
    exit 1
  }
  rm -f "${TMPDIR:-/tmp}/saccade-cmake.$$"
fi
cmake --build "$build" --parallel "$(nproc)" ${1:+--target "$@"}
