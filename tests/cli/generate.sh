#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# generate.sh MESHLODE_GENERATE MESHLODE: scenes of a size that was asked for are there, build, and have about that size.
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
echo "PASSED"
