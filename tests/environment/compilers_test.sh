#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# compilers_test.sh MESHLODE CMAKE SOURCE: programs that other compilers and options make build assets with MESHLODE's content
# hashes (I10): GCC and clang, not optimised and as far as they go, without and with what AVX2 and FMA offer. The sanitized
# program that tools/test.sh compares is a further one.
set -euo pipefail
meshlode=$(realpath "$1") cmake=$2 source=$(realpath "$3")
skip() { echo "SKIPPED: $*"; exit 77; }
command -v ninja >/dev/null || skip "no ninja"
command -v clang++-14 >/dev/null || skip "no clang++-14"
wide=
if grep -qw avx2 /proc/cpuinfo && grep -qw fma /proc/cpuinfo; then wide="-mavx2 -mfma"; fi
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
mkdir "$work/reference" && ln -s "$meshlode" "$work/reference/meshlode"
failed=0
# compare NAME C CXX FLAGS
compare() {
  local name=$1 build=$work/build
  echo "== $name"
  rm -rf "$build"
  "$cmake" -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="$2" -DCMAKE_CXX_COMPILER="$3" \
    -DCMAKE_CXX_FLAGS="$4" -DCMAKE_CXX_FLAGS_RELEASE=-DNDEBUG -DMESHLODE_TESTS=OFF -DMESHLODE_VULKAN=OFF -DMESHLODE_WASM=OFF \
    -DMESHLODE_UNITY=ON -DMESHLODE_WERROR=OFF -DCMAKE_CXX_COMPILER_LAUNCHER="${LAUNCHER:-}" >"$work/log" 2>&1 &&
    ninja -C "$build" meshlode_cli >"$work/log" 2>&1 || { tail -n 40 "$work/log"; echo "FAILED: $name does not build"; exit 1; }
  "$source/tests/cli/compare_compilers.sh" "$work/reference" "$build" || { echo "FAILED: $name"; failed=1; }
}
compare "clang, -O3 $wide" clang-14 clang++-14 "-O3 $wide"
compare "gcc, -O3 $wide" gcc g++ "-O3 $wide"
compare "gcc, not optimised" gcc g++ "-O0"
compare "clang, not optimised" clang-14 clang++-14 "-O0"
[ -n "$wide" ] || echo "not tried: AVX2 and FMA, which this processor has not"
exit $failed
