#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# portability_test.sh libcxx|windows CMAKE SOURCE MESHLODE READ_ASSET STORE_BY: base, format and run elsewhere (docs/reference/portability.md).
#   libcxx   compiled and linked by clang with libc++, as are GoogleTest and the tests of these floors, which must pass
#   windows  cross-compiled by mingw-w64, linked without any codec library, and run by Wine
# In both, READ_ASSET's counterpart must print what READ_ASSET prints: hashes of what assets decode to and which cuts there are,
# and what files do.
set -euo pipefail
which=$1 cmake=$2 source=$(realpath "$3") meshlode=$(realpath "$4") read_asset=$(realpath "$5") store_by=$(realpath "$6")
skip() { echo "SKIPPED: $*"; exit 77; }
fail() { echo "FAILED: $*"; exit 1; }
find_wine() { command -v wine64 || { [ -x /usr/lib/wine/wine64 ] && echo /usr/lib/wine/wine64; }; }
work=$(mktemp -d)
end() {
  [ -z "${WINEPREFIX:-}" ] || "$(dirname "$(readlink -f "$wine")")/wineserver64" -k 2>/dev/null || true
  rm -rf "$work"
}
trap end EXIT

command -v ninja >/dev/null || skip "no ninja"
compiler=(-G Ninja -DCMAKE_BUILD_TYPE=Release)
codecs="none strips" old_codecs=
case $which in
  libcxx)
    command -v clang++-14 >/dev/null || skip "no clang++-14"
    echo '#include <vector>
      int main() { return std::vector<int>().size(); }' >"$work/a.cpp"
    clang++-14 -stdlib=libc++ "$work/a.cpp" -o "$work/a" 2>/dev/null ||
      skip "no libc++: packages libc++-14-dev libc++abi-14-dev"
    [ -f /usr/src/googletest/CMakeLists.txt ] || skip "no source of GoogleTest: package googletest"
    old_codecs="lz4 zstd"
    compiler+=(-DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 -DCMAKE_CXX_FLAGS=-stdlib=libc++
               -DCMAKE_CXX_FLAGS_RELEASE=-O1) ;;
  windows)
    command -v x86_64-w64-mingw32-g++-posix >/dev/null || skip "no mingw-w64: package g++-mingw-w64-x86-64"
    wine=$(find_wine) || skip "no Wine: package wine64"
    # Headers alone, and not all of those beside them: they are this system's.
    mkdir "$work/include"
    ln -s /usr/include/xxhash.h /usr/include/glm "$work/include/"
    compiler+=(-DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=x86_64-w64-mingw32-gcc-posix
               -DCMAKE_CXX_COMPILER=x86_64-w64-mingw32-g++-posix "-DCMAKE_CXX_FLAGS=-isystem $work/include") ;;
  *) fail "libcxx or windows" ;;
esac
# quietly COMMAND...: its output where it fails
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; fail "$*"; }; }

echo "== assets"
mkdir "$work/assets"
for scene in city crystal rock; do
  for codec in $codecs; do
    quietly "$meshlode" build --quiet "$source/data/$scene.glb" -o "$work/assets/$scene.$codec.lode" --codec "$codec"
  done
  for codec in $old_codecs; do
    quietly "$store_by" "$codec" "$work/assets/$scene.none.lode" "$work/assets/$scene.$codec.lode"
  done
done
head -c 20000 "$work/assets/city.none.lode" >"$work/assets/short.lode"
# print_with COMMAND...: what the program prints of the assets, from an empty folder beside them
print_with() {
  rm -rf "$work/files"; mkdir "$work/files"
  (cd "$work/assets" && "$@" ../files -- *.lode | tr -d '\r')
}
print_with "$read_asset" >"$work/expected" || { cat "$work/expected"; fail "here"; }

echo "== compiling"
if [ "$which" = libcxx ]; then
  quietly "$cmake" -S /usr/src/googletest -B "$work/googletest" "${compiler[@]}" -DBUILD_GMOCK=OFF \
          -DCMAKE_INSTALL_PREFIX="$work/prefix"
  quietly "$cmake" --build "$work/googletest" --target install
  compiler+=(-DCMAKE_PREFIX_PATH="$work/prefix")
fi
build=$work/build
quietly "$cmake" -S "$source" -B "$build" "${compiler[@]}" -DMESHLODE_RUNTIME_ONLY=ON
quietly "$cmake" --build "$build"
quietly "$cmake" --build "$build" --target meshlode_read_asset
program=$build/tests/portability/meshlode_read_asset

echo "== running"
if [ "$which" = libcxx ]; then
  readelf -d "$program" | grep -q 'libc++\.so' || fail "not linked with libc++"
  readelf -d "$program" | grep -q 'libstdc++\.so' && fail "linked with libstdc++ too"
  quietly "${cmake%cmake}ctest" --test-dir "$build" --no-tests=error --output-on-failure
  sed -n '/% tests passed/p' "$work/log"
  print_with "$program" >"$work/printed" || { cat "$work/printed"; fail "with libc++"; }
else
  export WINEPREFIX=$work/wine WINEDEBUG=-all
  print_with "$wine" "$program.exe" 2>"$work/log" >"$work/printed" || { cat "$work/log" "$work/printed"; fail "with Wine"; }
fi
diff -u "$work/expected" "$work/printed" || fail "other output than here"
grep -c '^  integers ' "$work/printed" | sed 's/$/ assets read alike/'
echo "PASSED"
