#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# test.sh [--all | --all=GROUP]: installs what is missing (what the groups browser, docs, examples, npm, packages, portability, slurm and wasm
# need for themselves for --all and --all=GROUP alone), then
#   1. a release build and its tests (--all: the long ones too; --all=GROUP: those of them whose names have GROUP in them),
#   2. a sanitized core, built by clang with address and undefined behaviour sanitizers: the programs that read hostile
#      bytes and those of the rooms that do arithmetic on indices (label `sanitized`, without what is `slow`; --all: every program),
#   3. GCC against clang: the optimised program of part 1 and the sanitized one of part 2 must build assets with equal
#      content hashes (I10),
#   4. the form of the sources (tools/format.sh), and clang-tidy over those that changed (tools/tidy.sh; --all: over all).
# All parts run even where one fails; the exit code is 0 only where all passed. What was skipped is named at the end with its
# reason, and what failed with the last that it said.
# The last lines are ctest's summaries. Without --all no part can hang: each has a limit, 85 minutes in all.
set -uo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
all=no group=
case ${1:-} in
  '') ;;
  --all) all=yes ;;
  --all=?*) group=${1#--all=} ;;
  *) echo "usage: tools/test.sh [--all | --all=GROUP]" >&2; exit 1 ;;
esac
failed=()
logs=build/logs
mkdir -p "$logs"
rm -f "$logs"/*.log "$logs"/*.said
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1:allocator_may_return_null=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1:halt_on_error=1}

# Thousands of small files that nobody looks at again: in memory, where there is room, tests of batches take a fifth.
if [ -z "${TMPDIR:-}" ] && [ "$(df --output=avail /dev/shm 2>/dev/null | tail -n 1)" -ge $((4 * 1024 * 1024)) ] 2>/dev/null; then
  export TMPDIR=/dev/shm
fi

step() { echo; echo "== $* (after ${SECONDS} s)"; }
# part NAME COMMAND...: runs it, keeps its output, remembers a failure. 77 is a part that cannot run here, and says why.
part() {
  local name=$1 status; shift
  step "$name"
  "$@" 2>&1 | tee "$logs/${name// /-}.log"
  status=${PIPESTATUS[0]}
  [ "$status" -eq 0 ] || [ "$status" -eq 77 ] || { failed+=("$name"); return 1; }
}
# within MINUTES COMMAND...: a command that is not done by then is ended; --all takes as long as it takes.
within() {
  local minutes=$1 status; shift
  if [ $all = yes ]; then "$@"; return; fi
  timeout --kill-after=30 "${minutes}m" "$@"; status=$?
  [ $status -ne 124 ] && [ $status -ne 137 ] || echo "FAILED: not done after $minutes minutes: $*"
  return $status
}
# run_ctest MINUTES BUILD NAME FILTER...: what each test said stays beside the log of the part NAME.
run_ctest() {
  local minutes=$1 build=$2 name=$3 status; shift 3
  within "$minutes" ctest --test-dir "$build" -j "$jobs" --output-on-failure --no-tests=error "$@"; status=$?
  cp "$build/Testing/Temporary/LastTest.log" "$logs/${name// /-}.said"
  return $status
}

release_targets=(all)
[ "$all$group" = no ] || release_targets=(all slow_tests)
build_release() {
  cmake --preset release -DMESHLODE_TESTS=ON -DMESHLODE_UNITY=ON && within 25 ninja -C build/release -j "$jobs" "${release_targets[@]}"
}
release_filter=(-LE slow)
[ $all = yes ] && release_filter=()
test_release() { run_ctest 25 build/release "release tests" "${release_filter[@]}"; }
test_group() { run_ctest 60 build/release "long tests" -L slow -R "$group"; }
if [ $all = yes ]; then
  sanitized_targets=(all slow_tests) sanitized_vulkan=ON sanitized_filter=(-LE "models|install" -E TwoThousandScenes)
else
  # Of the program what compare_compilers.sh asks of it; Vulkan is not run here.
  sanitized_targets=(sanitized_core meshlode_cli) sanitized_vulkan=OFF sanitized_filter=(-L sanitized -LE slow)
fi
build_sanitized() {
  cmake --preset sanitize -DMESHLODE_VULKAN=$sanitized_vulkan -DMESHLODE_UNITY=ON &&
    within 12 ninja -C build/sanitize -j "$jobs" "${sanitized_targets[@]}"
}
test_sanitized() { run_ctest 12 build/sanitize "sanitized tests" "${sanitized_filter[@]}"; }
check_format() { tools/format.sh --check; }
check_tidy() {
  local which=()
  [ $all = no ] || which=(--all)
  within 6 tools/tidy.sh "${which[@]}"
}
compare_compilers() { within 5 tests/cli/compare_compilers.sh build/release build/sanitize; }

# skipped NAME: the tests of a part that did not run, with the reason that each gave.
skipped() {
  awk '
    FNR == NR && / Testing: / { name = $0; sub(/.* Testing: /, "", name) }
    FNR == NR && /^SKIPPED: / && !(name in reason) { reason[name] = substr($0, 10) }
    FNR == NR && /: Skipped$/ && !(name in reason) { getline; reason[name] = $0 }
    FNR != NR && / \((Skipped|Disabled)\)$/ {
      sub(/^[ \t]*[0-9]+ - /, ""); sub(/ \([A-Za-z]+\)$/, "")
      print "  " $0 ": " ($0 in reason ? reason[$0] : "no reason given"); count++
    }
    END { if (count == 0) print "  none" }
  ' "$logs/$1.said" "$logs/$1.log"
}

# failures NAME: what the tests of a part that failed said last, for who sees only the end of all this.
failures() {
  awk -v most=40 '
    / Testing: / { name = $0; sub(/.* Testing: /, "", name); is_said = 0 }
    /^Output:$/ { count = -1; next }  # a line of dashes follows
    /^<end of output>$/ { is_said = 1 }
    !is_said && count++ >= 0 { said[count] = $0 }
    /^Test Failed\.$/ {
      print "-- " name ": failed"
      for (i = count > most ? count - most + 1 : 1; i <= count; i++) print "  " said[i]
    }
  ' "$logs/$1.said"
}

groups=()
for name in browser docs examples npm packages portability slurm wasm; do
  [ $all = no ] && [[ $group != *$name* ]] || groups+=(--"$name")
done
tools/install-deps.sh --tests "${groups[@]}" || exit 1
part "format" check_format
part "release build" build_release && part "release tests" test_release
[ -z "$group" ] || part "long tests" test_group
if part "sanitized build" build_sanitized; then
  part "gcc against clang" compare_compilers
  part "sanitized tests" test_sanitized
fi

part "names" check_tidy

step "done"
for name in format names; do
  grep -h '^SKIPPED: ' "$logs/$name.log"
done
for name in release-tests long-tests sanitized-tests; do
  [ -f "$logs/$name.said" ] && [ -f "$logs/$name.log" ] || continue
  echo "-- skipped of the ${name//-/ }:"
  skipped "$name"
done
for name in release-tests long-tests sanitized-tests; do
  [ ! -f "$logs/$name.said" ] || failures "$name"
done
for log in "$logs/gcc-against-clang.log" "$logs/sanitized-tests.log" "$logs/long-tests.log" "$logs/release-tests.log"; do
  [ -f "$log" ] || continue
  echo "-- $(basename "$log" .log)"
  if grep -q '% tests passed' "$log"; then
    # ctest's summary; of its lists the failures alone, not what was skipped.
    sed -n '/% tests passed/,$p' "$log" | grep -v '^$\|Label Time Summary\|(Skipped)\|did not run:'
  else
    tail -n 1 "$log"
  fi
done
tools/release-check --age
if [ ${#failed[@]} -ne 0 ]; then
  printf 'FAILED: %s\n' "${failed[@]}"
  exit 1
fi
echo "all parts passed in ${SECONDS} s"
