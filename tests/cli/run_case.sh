#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run_case.sh MESHLODE JSON_CHECK CASE.sh: runs a case in an empty folder and compares what it prints with CASE.expected
# beside it. A case calls
#   run ARGS…     the command, its output and errors, and its exit code
#   code ARGS…    the command and its exit code; where it failed also how many lines it printed on stderr
#   files         the files in the folder, so that nothing partial is left unseen
#   "$STORE_BY"   tests/support/old_codecs/store_by.cpp
#   skip REASON   what cannot be tried here; the exit code is 77
# UPDATE=1 writes CASE.expected instead.
set -uo pipefail
MESHLODE=$(realpath "$1"); JSON_CHECK=$(realpath "$2"); STORE_BY=$(dirname "$JSON_CHECK")/../support/store_by; case_file=$(realpath "$3")
expected=${case_file%.sh}.expected
REPOSITORY=$(cd "$(dirname "$0")/../.." && pwd)
DATA=$REPOSITORY/data
SCHEMAS=$REPOSITORY/docs/schemas
unset MESHLODE_CACHE
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir work && cd work

run() { echo "\$ meshlode $*"; "$MESHLODE" "$@" 2>&1; echo "exit $?"; }
code() {
  local status
  "$MESHLODE" "$@" >../stdout 2>../stderr; status=$?
  echo "\$ meshlode $*"
  if [ "$status" -ne 0 ]; then
    echo "exit $status, $(grep -cE '^meshlode( [a-z]+)?: ' ../stderr) error line(s)"
  else
    echo "exit 0"
  fi
}
skip() { echo "SKIPPED: $(basename "$case_file"): $*" >&3; exit 77; }
files() { echo "files:"; find . -type f | LC_ALL=C sort; }
# json SCHEMA ARGS…: stdout must be one JSON document that the schema accepts.
json() {
  local schema=$1; shift
  echo "\$ meshlode $*"
  "$MESHLODE" "$@" 2>../stderr | "$JSON_CHECK" "$SCHEMAS/$schema.schema.json"
}

exec 3>&1
# shellcheck disable=SC1090
source "$case_file" >../actual 2>&1
if [ "${UPDATE:-0}" = 1 ]; then
  cp ../actual "$expected"
fi
diff -u "$expected" ../actual || { echo "FAILED: $(basename "$case_file"); where the new output is right: UPDATE=1"; exit 1; }
echo "PASSED: $(basename "$case_file")"
