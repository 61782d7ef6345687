#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# format.sh [--check] [FILE…]: brings the C++ and C files that git tracks (all where there is no git, or those named) into the
# form of .clang-format. --check changes nothing, names the files that differ and exits 1. Exit 77, aloud, where there is no
# clang-format 14: another version would format otherwise.
set -euo pipefail
cd "$(dirname "$0")/.."
check=no
if [ "${1:-}" = --check ]; then check=yes; shift; fi
case ${1:-} in -*) echo "usage: tools/format.sh [--check] [FILE…]" >&2; exit 1 ;; esac

skip() { echo "SKIPPED: tools/format.sh: $*"; exit 77; }
format=
for candidate in clang-format-14 clang-format; do
  if command -v "$candidate" >/dev/null && "$candidate" --version | grep -q 'version 14\.'; then format=$candidate; break; fi
done
[ -n "$format" ] || skip "no clang-format 14"

files=("$@")
if [ ${#files[@]} -eq 0 ]; then
  mapfile -t files < <(git ls-files -- '*.h' '*.cpp' '*.c' '*.inl' 2>/dev/null ||
                       find include src tools tests bench -name '*.h' -o -name '*.cpp' -o -name '*.c' -o -name '*.inl')
fi

if [ $check = no ]; then
  printf '%s\0' "${files[@]}" | xargs -0 -P "$(nproc)" -n 32 "$format" -i --style=file
  exit 0
fi
differing=$(printf '%s\0' "${files[@]}" | xargs -0 -P "$(nproc)" -n 32 "$format" --style=file --dry-run 2>&1 |
            sed -n 's/^\([^:]*\):[0-9]*:[0-9]*: .*\[-Wclang-format-violations\]$/\1/p' | sort -u)
[ -n "$differing" ] || exit 0
echo "$differing"
echo "tools/format.sh: $(wc -l <<<"$differing") file(s) are not in the form of .clang-format" >&2
exit 1
