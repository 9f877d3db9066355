#!/bin/sh
# Builds Saccade (installing what a bare Debian 12 lacks) and explores a scene with it.
#   apps/demo.sh           the embedded desk
#   apps/demo.sh INPUT     a folder of your own
# Leaves a session, a video and pictures in demo/.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=${SACCADE_BUILD_DIR:-$root/build}
input=${1:-sim:desk}
out=$root/demo

[ -f "$build/build.ninja" ] || options=-DCMAKE_BUILD_TYPE=Release
"$root/apps/build.sh" "$build" ${options:-} -- saccade_program
mkdir -p "$out"
saccade=$build/apps/saccade/saccade
"$saccade" explore "$input" -o "$out/demo.saccade" --force --video "$out/demo.mp4" --frames-dir "$out/frames"
echo
"$saccade" inspect "$out/demo.saccade"
echo
echo "Look at a picture:  $(ls "$out"/frames/*.png | sed -n '$p')"
echo "Watch the video:    $out/demo.mp4"
echo "Explore your own:   $saccade explore FOLDER -o my.saccade"
