#!/bin/sh
# Installs Saccade from BUILD into a folder of its own and builds an outside project against it.
set -eu
build=$1
here=$(cd "$(dirname "$0")" && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cmake --install "$build" --prefix "$place/installed" >/dev/null
"$place/installed/bin/saccade" --version
cmake -S "$here/outside_project" -B "$place/build" -DCMAKE_PREFIX_PATH="$place/installed" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$place/build" >/dev/null
"$place/build/outside"
