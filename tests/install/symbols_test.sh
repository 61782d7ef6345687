#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# symbols_test.sh SOURCE C_LIBRARY BUILD_LIBRARY: the shared libraries have their sonames and show exactly the symbols of
# tests/install/symbols, no more (a host's own functions are not replaced) and no fewer (what was linked against an older
# build still runs). UPDATE=1 writes these lists anew.
set -euo pipefail
source=$1 c_library=$2 build_library=$3
lists=$source/tests/install/symbols
failed=0
fail() { echo "FAILED: $*"; failed=1; }

shown() { nm -D -C --defined-only "$1" | sed 's/^[0-9a-f]* [A-Za-z] //' | LC_ALL=C sort; }
# holds LIBRARY NAME: its soname and its symbols
holds() {
  local soname
  soname=$(readelf -d "$1" | sed -n 's/.*(SONAME).*\[\(.*\)\].*/\1/p')
  [ "$soname" = "lib$2.so.0" ] || fail "$1 has the soname '$soname', not lib$2.so.0"
  [ "${UPDATE:-0}" != 1 ] || shown "$1" >"$lists/$2.symbols"
  diff -u "$lists/$2.symbols" <(shown "$1") || fail "$1 shows other symbols than $2.symbols"
}
holds "$c_library" meshlode
holds "$build_library" meshlode_build

# What the C headers declare is what the libraries have.
declared() { sed -n 's/^MESHLODE_API .*\(meshlode_[a-z0-9_]*\)(.*/\1/p' "$source/include/meshlode/$1" | LC_ALL=C sort; }
diff -u "$lists/meshlode.symbols" <(declared meshlode.h) || fail "meshlode.h declares other functions"
diff -u <(grep '^meshlode_' "$lists/meshlode_build.symbols") <(declared meshlode_build.h) ||
  fail "meshlode_build.h declares other functions"
[ $failed -eq 0 ] || exit 1
echo "PASSED: $(wc -l <"$lists/meshlode.symbols") symbols of C, $(wc -l <"$lists/meshlode_build.symbols") of the builder"
