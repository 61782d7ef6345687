#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tidy.sh [--all | FILE…]: clang-tidy with .clang-tidy and the compile commands of the preset `clang`, over all sources, the
# files given, or the sources that changed since MESHLODE_TIDY_BASE (HEAD~1 by default). Exit 1 with what it found; 77 where
# it cannot run, with the reason.
set -uo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
skip() { echo "SKIPPED: $*"; exit 77; }
tidy=$(command -v clang-tidy-14 || command -v clang-tidy) || skip "no clang-tidy"

base=${MESHLODE_TIDY_BASE:-HEAD~1}
case ${1:-} in
  --all) mapfile -t files < <(git ls-files '*.cpp' || find src tools tests bench -name '*.cpp') ;;
  '') git rev-parse --verify -q "$base^{commit}" >/dev/null || skip "no history: $base is not there"
      mapfile -t files < <({ git diff --name-only --diff-filter=d "$base" -- '*.cpp'
                             git ls-files --others --exclude-standard -- '*.cpp'
                             # Of a header what lies beside it, or else the first file that includes it.
                             git diff --name-only --diff-filter=d "$base" -- '*.h' | while read -r header; do
                               if [ -f "${header%.h}.cpp" ]; then echo "${header%.h}.cpp"; continue; fi
                               git grep -l "include [\"<]${header#*/}" -- '*.cpp' | head -n 1
                             done; } | sort -u) ;;
  *) files=("$@") ;;
esac
[ ${#files[@]} -ne 0 ] || { echo "clang-tidy: no source changed since $base"; exit 0; }

cmake --preset clang -DMESHLODE_TESTS=ON -DMESHLODE_BENCH=ON -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null || exit 1
ninja -C build/clang meshlode_shaders meshlode_app_embedded >/dev/null || exit 1
# Only what the build compiles: the consumer of tests/install has its own.
known=()
for file in "${files[@]}"; do
  if grep -q "\"file\": \"$PWD/$file\"" build/clang/compile_commands.json; then
    known+=("$file")
  else
    echo "clang-tidy: $file is not compiled by the preset clang, and not looked at"
  fi
done
[ ${#known[@]} -ne 0 ] || { echo "clang-tidy: nothing to look at"; exit 0; }
echo "clang-tidy: ${#known[@]} files"
printf '%s\n' "${known[@]}" | xargs -P "$jobs" -n 1 "$tidy" -p build/clang --quiet 2>/dev/null |
  grep -E '(warning|error):' | sort -u
found=("${PIPESTATUS[@]}")
if [ "${found[1]}" -ne 0 ]; then echo "clang-tidy: findings above"; exit 1; fi
echo "clang-tidy: nothing found"
