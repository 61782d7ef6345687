#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# test.sh [--all]: installs what is missing, then
#   1. a release build and its tests (--all: the long ones too),
#   2. a sanitized core: the unit tests of the rooms, built by clang with address and undefined behaviour sanitizers,
#   3. GCC against clang: the optimised program of part 1 and the sanitized one of part 2 must build assets with equal
#      content hashes (I10).
# All parts run even where one fails; the exit code is 0 only where all passed. The last lines are ctest's summaries.
set -uo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
filter=(-LE slow)
[ "${1:-}" = --all ] && filter=()
failed=()
logs=build/logs
mkdir -p "$logs"
rm -f "$logs"/*.log
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1:allocator_may_return_null=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1:halt_on_error=1}

step() { echo; echo "== $* (after ${SECONDS} s)"; }
# part NAME COMMAND...: runs it, keeps its output, remembers a failure.
part() {
  local name=$1; shift
  step "$name"
  "$@" 2>&1 | tee "$logs/${name// /-}.log"
  [ "${PIPESTATUS[0]}" -eq 0 ] || { failed+=("$name"); return 1; }
}

build_release() { cmake --preset release -DMESHLODE_TESTS=ON && ninja -C build/release -j "$jobs"; }
test_release() {
  ctest --test-dir build/release -j "$jobs" --output-on-failure --no-tests=error "${filter[@]}"
}
# The rooms' unit tests and hostile bytes; whole builds of models and long series of mutants are for --all.
if [ "${1:-}" = --all ]; then
  sanitized_targets=(all) sanitized_filter=(-LE "models|install")
else
  sanitized_targets=(sanitized_core meshlode_cli) sanitized_filter=(-L "unit|malformed" -LE "slow|models")
fi
build_sanitized() { cmake --preset sanitize && ninja -C build/sanitize -j "$jobs" "${sanitized_targets[@]}"; }
test_sanitized() {
  ctest --test-dir build/sanitize -j "$jobs" --output-on-failure --no-tests=error "${sanitized_filter[@]}"
}
compare_compilers() { tests/cli/compare_compilers.sh build/release build/sanitize; }

tools/install-deps.sh --tests || exit 1
part "release build" build_release && part "release tests" test_release
if part "sanitized build" build_sanitized; then
  part "gcc against clang" compare_compilers
  part "sanitized tests" test_sanitized
fi

step "done"
for log in "$logs/gcc-against-clang.log" "$logs/sanitized-tests.log" "$logs/release-tests.log"; do
  [ -f "$log" ] || continue
  echo "-- $(basename "$log" .log)"
  if grep -q '% tests passed' "$log"; then
    # ctest's summary; of its lists the failures alone, not what was skipped.
    sed -n '/% tests passed/,$p' "$log" | grep -v '^$\|Label Time Summary\|(Skipped)\|did not run:'
  else
    tail -n 1 "$log"
  fi
done
if [ ${#failed[@]} -ne 0 ]; then
  printf 'FAILED: %s\n' "${failed[@]}"
  exit 1
fi
echo "all parts passed in ${SECONDS} s"
