#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# generate.sh MESHLODE_GENERATE MESHLODE: scenes of a size that was asked for are there, build, and have about that size;
# and one of them with as much memory as the estimate says, and with less.
set -euo pipefail
generate=$(realpath "$1"); meshlode=$(realpath "$2")
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { echo "FAILED: $*"; exit 1; }
expect_usage() {  # ARGS…: exit 1, one line, nothing written
  local status=0
  "$generate" "$@" >stdout 2>stderr || status=$?
  [ "$status" -eq 1 ] || fail "$*: exit $status"
  [ "$(wc -l <stderr)" -eq 1 ] || fail "$*: $(cat stderr)"
  [ ! -e out ] || fail "$*: something was written"
}

expect_usage
expect_usage out --triangles
expect_usage out --terrain 42
for number in '' lots 1 0 -5 1.5K 16m 101M 100000001 99999999999999999999; do expect_usage out --triangles "$number"; done

"$generate" out --triangles 2K
"$generate" out --triangles 2000
[ "$(find out -type f | wc -l)" -eq 1 ] || fail "2K and 2000 are two files"
file=$(find out -type f)
"$meshlode" build "$file" -o terrain.lode --quiet --error-tier qem
triangles=$("$meshlode" extract terrain.lode --error 0 -o x.glb | grep -oE '[0-9]+ triangles' | head -1 | cut -d' ' -f1)
[ "$triangles" -ge 1900 ] && [ "$triangles" -le 2100 ] || fail "$triangles triangles"

# With as much as one thread is said to need it is kept, with the same bytes; with less it is refused before work.
"$generate" large --triangles 400K
file=$(find large -type f)
build=("$meshlode" build "$file" --quiet --preset fast)
"${build[@]}" -o whole.lode --jobs 1 --report whole.json
kib=$(( ($(grep -oE '"memory_estimate_bytes": ?[0-9]+' whole.json | grep -oE '[0-9]+$') + 1023) / 1024 ))
time=(); [ ! -x /usr/bin/time ] || time=(/usr/bin/time -f %M -o "$work.peak")
"${time[@]}" "${build[@]}" -o kept.lode --jobs 2 --max-memory "${kib}KiB"
cmp whole.lode kept.lode || fail "$kib KiB: other bytes"
peak=0; [ ! -e "$work.peak" ] || { peak=$(cat "$work.peak"); rm "$work.peak"; }
[ "$peak" -le "$kib" ] || fail "$kib KiB: $peak KiB were taken"
status=0; "${build[@]}" -o refused.lode --jobs 2 --max-memory $((kib - 1024))KiB 2>stderr || status=$?
[ "$status" -eq 4 ] && [ ! -e refused.lode ] || fail "1 MiB less: exit $status"
grep -q "the build needs about .* of memory, .* of it for mesh 0 .*; .* are allowed by --max-memory: allow more" stderr ||
  fail "1 MiB less: $(cat stderr)"
echo "PASSED"
