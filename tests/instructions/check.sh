#!/bin/sh
# Counts the instructions of each stage under callgrind and compares them with the recorded ones: noise cannot move
# them, a change of the code can.
#   check.sh PROGRAM          fails if a stage needs more than 10 % more than recorded
#   check.sh PROGRAM --update records what is counted now; do so in the commit that changes a stage's cost, and say why
# Exits with 77 (skipped) where counts mean nothing: without valgrind, with another compiler than the recorded one, or
# on a processor that runs other kernels.
set -eu
program=$1
here=$(cd "$(dirname "$0")" && pwd)
recorded=$here/recorded.tsv
skip() {
  echo "skipped: $1"
  exit 77
}
command -v valgrind > /dev/null || skip "valgrind is not installed"
grep -q avx2 /proc/cpuinfo 2> /dev/null || skip "the recorded counts are those of AVX2 kernels"
compiler=$(readelf --string-dump=.comment "$program" 2> /dev/null | sed -n 's/.*\(GCC: ([^)]*) [0-9]*\).*/\1/p' | head -n 1)
[ -n "$compiler" ] || skip "the recorded counts are those of GCC"
if [ "${2-}" != --update ]; then
  [ "$compiler" = "$(sed -n 's/^# compiler: //p' "$recorded")" ] || skip "recorded with another compiler than $compiler"
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
if ! valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file="$folder/counts" "$program" 2> "$folder/log"; then
  cat "$folder/log" >&2
  exit 1
fi
for dump in "$folder"/counts.*; do
  sed -n 's/^desc: Trigger: Client Request: //p; s/^\(totals\|summary\): //p' "$dump" | head -n 2 | paste -s -d '\t' -
done | sort > "$folder/now.tsv"

if [ "${2-}" = --update ]; then
  {
    echo "# Instructions of each stage on a simulated frame, recorded by check.sh --update"
    echo "# compiler: $compiler"
    cat "$folder/now.tsv"
  } > "$recorded"
  exit 0
fi
awk -F '\t' '
  NR == FNR { if ($0 !~ /^#/) before[$1] = $2; next }
  { seen[$1] = 1
    if (!($1 in before)) { printf "%s: not recorded; run check.sh --update\n", $1; bad = 1; next }
    ratio = $2 / before[$1]
    printf "%-20s %12d  %+6.1f %%%s\n", $1, $2, 100 * (ratio - 1), (ratio > 1.10 ? "  TOO MANY" : "")
    if (ratio > 1.10) bad = 1 }
  END { for (stage in before) if (!(stage in seen)) { printf "%s: recorded, but not counted\n", stage; bad = 1 }
        exit bad }' "$recorded" "$folder/now.tsv"
