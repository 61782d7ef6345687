#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# generate.sh MESHLODE_GENERATE MESHLODE: scenes of a size that was asked for are there, build, and have about that size;
# and one of them with less memory than it takes (tools/meshlode/spill.h).
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

# The temporary file is made in /var/tmp, for the folder here may lie in memory.
case $(stat -f -c %T /var/tmp) in tmpfs|ramfs) echo "PASSED, but for --max-memory: /var/tmp lies in memory"; exit 0 ;; esac
# Below what it needs with a temporary file: refused. Between that and what it takes without: kept, with the same bytes.
"$generate" large --triangles 400K
file=$(find large -type f)
build=("$meshlode" build "$file" --quiet --preset fast)
status=0; "${build[@]}" -o refused.lode --jobs 1 --max-memory 60MiB 2>stderr || status=$?
[ "$status" -eq 4 ] && [ ! -e refused.lode ] || fail "60MiB: exit $status"
grep -q 'the build needs about .* of memory, 60MiB are allowed by --max-memory' stderr || fail "60MiB: $(cat stderr)"
"${build[@]}" -o whole.lode --jobs 2 --report whole.json
[ "$(grep -oE '"memory_estimate_bytes": ?[0-9]+' whole.json | grep -oE '[0-9]+$')" -gt $((92 << 20)) ] ||
  fail "this terrain is too small for a test"
before=$(find . | sort)
time=(); [ ! -x /usr/bin/time ] || time=(/usr/bin/time -f %M -o "$work.peak")
# /dev/shm is memory, and no place for the file.
TMPDIR=/dev/shm "${time[@]}" "${build[@]}" -o spilled.lode --jobs 1 --max-memory 92MiB
cmp whole.lode spilled.lode || fail "92MiB: other bytes"
rm spilled.lode
[ "$before" = "$(find . | sort)" ] || fail "something is left behind"
peak=0; [ ! -e "$work.peak" ] || { peak=$(cat "$work.peak"); rm "$work.peak"; }
[ "$peak" -le $((92 << 10)) ] || fail "92MiB: $peak KiB were taken"

# A file that may not grow is as a disk without room. What is small enough is built all the same.
status=0
(trap '' XFSZ; ulimit -f 8000; exec "${build[@]}" out/*.glb -O full --jobs 1 --max-memory 92MiB) 2>stderr || status=$?
[ "$status" -eq 4 ] || fail "no room: exit $status"
[ "$(cd full && echo *)" = terrain-2000.lode ] || fail "no room: $(cd full && echo *)"
grep -q 'terrain-400000.glb: out of memory' stderr || fail "no room: $(cat stderr)"
grep -q 'no room for the temporary file of --max-memory' stderr || fail "no room: $(cat stderr)"
echo "PASSED"
