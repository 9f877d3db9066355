#!/bin/sh
# Checks form and common mistakes: clang-format over all C++ files, clang-tidy (see .clang-tidy) over those of the
# library and the program, some 15 s a file. Installs what it needs.
#   tests/lint.sh              all files
#   tests/lint.sh --format     clang-format only
#   tests/lint.sh FILE...      clang-tidy on these source files only
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=${SACCADE_BUILD_DIR:-$root/build}-lint
cd "$root"
"$root/apps/install-packages.sh" clang-format
git ls-files '*.cpp' '*.hpp' '*.inl' | xargs clang-format --dry-run -Werror
[ "${1:-}" != "--format" ] || exit 0
"$root/apps/install-packages.sh" clang clang-tidy $(grep -v '^#' apps/packages.txt)
# Configured for clang, which does not know all of GCC's options; nothing is built.
[ -f "$build/compile_commands.json" ] ||
  cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=Release -DSACCADE_BUILD_TESTS=OFF >/dev/null
[ $# -gt 0 ] || set -- $(git ls-files 'src/*.cpp' 'apps/*.cpp')
printf '%s\n' "$@" | xargs -P "$(nproc)" -n 4 clang-tidy --quiet -p "$build" 2>/dev/null
