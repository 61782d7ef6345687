#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh SECONDS [HARNESS…]: fuzzes each harness (all by default) for SECONDS, JOBS at once (1 by default), with what
#   cmake --preset fuzz && ninja -C build/fuzz fuzzers
# built. Prints the runs and the user seconds of each. The grown corpora stay in build/fuzz/corpus, findings go to
# build/fuzz/findings; exit 1 where there is one.
set -uo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$root/build/fuzz
seconds=${1:?run.sh SECONDS [HARNESS…]}; shift
harnesses=("$@"); [ $# -gt 0 ] || harnesses=(reader head judge codecs importer textures render verify stored)
jobs=${JOBS:-1}
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
mkdir -p "$build/findings" "$build/scratch"
export MESHLODE_FUZZ_TMP=$build/scratch
[ -d /dev/shm ] && MESHLODE_FUZZ_TMP=/dev/shm
"$build/tests/fuzz/fuzz_seeds" "$build/seeds" || exit 2

fuzz() {
  local name=$1 status
  mkdir -p "$build/corpus/$name"
  local options=(-max_total_time="$seconds" -timeout=25 -rss_limit_mb=2048 -print_final_stats=1
                 -artifact_prefix="$build/findings/$name-")
  case $name in
    importer) options+=(-dict="$root/tests/fuzz/gltf.dict" -max_len=8192) ;;
    *) options+=(-max_len=40000) ;;
  esac
  local folders=("$build/corpus/$name" "$build/seeds/$name")
  [ -d "$root/tests/fuzz/corpus/$name" ] && folders+=("$root/tests/fuzz/corpus/$name")
  local TIMEFORMAT=%U
  { time "$build/tests/fuzz/fuzz_$name" "${options[@]}" "${folders[@]}" >"$build/$name.log" 2>&1; } 2>"$build/$name.user"
  status=$?
  local runs
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$name.log")
  echo "$name: ${runs:-0} runs, $(tail -n 1 "$build/$name.user") s user$([ $status -eq 0 ] || echo ", FOUND SOMETHING (exit $status)")"
  grep -E '^(finding:|==[0-9]+==ERROR|SUMMARY:|.*runtime error)' "$build/$name.log" | head -n 5
  return $status
}

failed=0
running=0
for name in "${harnesses[@]}"; do
  if [ "$running" -ge "$jobs" ]; then
    wait -n || failed=1
    running=$((running - 1))
  fi
  fuzz "$name" &
  running=$((running + 1))
done
for ((; running > 0; running--)); do wait -n || failed=1; done
ls "$build/findings"
exit $failed
