#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# packages_test.sh CPACK BUILD_FOLDER SOURCE: cpack makes the Debian packages; their files are those of
# tests/install/packages, and they depend on what their binaries need.
set -euo pipefail
cpack=$1 build=$2 source=$3
for tool in file dpkg-shlibdeps dpkg-deb; do
  command -v "$tool" >/dev/null || { echo "SKIPPED: no $tool"; exit 77; }
done
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
failed=0
fail() { echo "FAILED: $*"; failed=1; }

"$cpack" --config "$build/CPackConfig.cmake" -B "$work" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
deb() { echo "$work/$1_"*.deb; }
# files_of PACKAGE: as a release build with a plain lib folder names them; any verb, any schema
files_of() {
  dpkg-deb --fsys-tarfile "$(deb "$1")" | tar t | grep -v '/$' |
    sed 's|^\./usr/lib/[a-z0-9_]*-linux-gnu/|./usr/lib/|; s|Targets-[a-z]*\.cmake$|Targets-release.cmake|
         s|man1/meshlode-[a-z]*\.1$|man1/meshlode-VERB.1|; s|schemas/[a-z]*\.schema|schemas/NAME.schema|' | LC_ALL=C sort -u
}
field() { dpkg-deb -f "$(deb "$1")" "$2"; }
for list in "$source"/tests/install/packages/*.files; do
  name=$(basename "$list" .files)
  [ -f "$(deb "$name")" ] || { fail "no package $name"; continue; }
  diff -u "$list" <(files_of "$name") || fail "$name has other files"
  dpkg-deb --fsys-tarfile "$(deb "$name")" | tar tv | grep -Ev '^(drwxr-xr-x|-rw-r--r--|-rwxr-xr-x|lrwxrwxrwx) root/root ' &&
    fail "$name: modes or owners of the files above"
  echo "$name depends on $(field "$name" Depends)"
done
[ "$(find "$work" -maxdepth 1 -name '*.deb' | wc -l)" -eq 3 ] || fail "not three packages"

# names PACKAGE: what it depends on, without versions
names() { field "$1" Depends | tr ',' '\n' | sed 's/^ *//; s/ .*//' | LC_ALL=C sort | tr '\n' ' '; }
[ "$(names libmeshlode0)" = "libc6 " ] || fail "libmeshlode0 depends on $(names libmeshlode0)"
for needed in libc6 libstdc++6 libtbb12 libopenmesh1 libpng16-16; do
  names meshlode | tr ' ' '\n' | grep -qxF -- "$needed" || fail "meshlode does not depend on $needed"
done
names meshlode | tr ' ' '\n' | grep -e '-dev$' && fail "meshlode depends on packages for developers"
version=$(field meshlode Version)
for own in "libmeshlode0 (= $version)" "meshlode (= $version)"; do
  field libmeshlode-dev Depends | tr ',' '\n' | sed 's/^ *//' | grep -qxF -- "$own" ||
    fail "libmeshlode-dev does not depend on $own"
done
dpkg-deb --ctrl-tarfile "$(deb libmeshlode0)" | tar xO ./shlibs | grep -qxF "libmeshlode 0 libmeshlode0 (= $version)" ||
  fail "libmeshlode0 does not say who has libmeshlode.so.0"
# Nobody's debugging symbols are shipped.
mkdir "$work/tools"; dpkg-deb -x "$(deb meshlode)" "$work/tools"
file "$work/tools/usr/bin/meshlode" | grep -q 'not stripped' && fail "the program is not stripped"
[ $failed -eq 0 ] || exit 1
echo "PASSED: three packages of version $version"
