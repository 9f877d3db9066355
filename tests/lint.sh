#!/bin/sh
# Checks form and common mistakes: clang-format over all C++ files, clang-tidy (see .clang-tidy) over those of the
# library and the program. Installs both tools where they are missing.
#   tests/lint.sh              all files
#   tests/lint.sh FILE...      these source files
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=${SACCADE_BUILD_DIR:-$root/build}
cd "$root"
"$root/apps/install-packages.sh" clang-format clang-tidy
git ls-files '*.cpp' '*.hpp' '*.inl' | xargs clang-format --dry-run -Werror
[ -f "$build/compile_commands.json" ] || "$root/apps/build.sh" "$build" -DCMAKE_BUILD_TYPE=Release
[ $# -gt 0 ] || set -- $(git ls-files 'src/*.cpp' 'apps/*.cpp')
printf '%s\n' "$@" | xargs -P "$(nproc)" -n 4 clang-tidy --quiet -p "$build"
