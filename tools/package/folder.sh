#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# folder.sh BUILD FOLDER: the program as one folder that runs from anywhere on any Linux for x86-64: with its shared libraries,
# their own loader and libc, man pages, completion scripts, schemas and the licence of everything inside. BUILD is a release build
# on Debian 12 of the target meshlode_manual, which makes the program and its pages; FOLDER is made, and replaced where it was made
# by this script. The folder is the npm package meshlode-cli too: `npm pack FOLDER`. docs/guides/packages.md
set -euo pipefail
fail() { echo "folder.sh: $*" >&2; exit 1; }
[ $# -eq 2 ] || { sed -n '3,6s/^# //p' "$0" >&2; exit 1; }
source=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd) folder=$2
[ "$(uname -sm)" = "Linux x86_64" ] || fail "made on Linux for x86-64 alone"
command -v dpkg-query >/dev/null || fail "made on Debian, whose packages say what the licences are"
for file in meshlode man/meshlode.1 completions/meshlode; do
  [ -e "$build/$file" ] || fail "$build/$file is missing: cmake --build $1 --target meshlode_manual"
done
if [ -e "$folder" ]; then
  grep -qs '"name": "meshlode-cli"' "$folder/package.json" || fail "$folder is there, and is no folder of this script"
  rm -rf "$folder"
fi
umask 022
mkdir -p "$folder"/{bin,libexec,lib/libc,licences/libraries,share/{meshlode/schemas,man/man1,bash-completion/completions,zsh/site-functions,fish/vendor_completions.d}}
folder=$(cd "$folder" && pwd)

"${CXX:-c++}" -std=c++20 -O2 -static -s "$source/tools/package/launcher.cpp" -o "$folder/bin/meshlode"
install -m 755 "$build/meshlode" "$folder/libexec/meshlode"
strip "$folder/libexec/meshlode"

# What the program is linked with, by all steps, the loader, and what oneTBB opens by name as it starts.
linked=$(ldd "$build/meshlode")
! grep -F 'not found' <<<"$linked" >&2 || fail "the libraries above are missing"
libraries=$(sed -nE 's/.*=> (\/[^ ]+) .*/\1/p; s/^\s+(\/[^ ]+) .*/\1/p' <<<"$linked")
beside() { dirname "$(grep "/$1\.so" <<<"$libraries")"; }
libraries+=" $(beside libtbb)/libtbbmalloc.so.2"
# Of the same libc what drivers of older distributions are linked with.
for name in libdl.so.2 libpthread.so.0 librt.so.1 libutil.so.1 libresolv.so.2; do
  libraries+=" $(beside libc)/$name"
done
# The packages whose headers are compiled into the program, beside those of its shared libraries.
packages=(libboost1.74-dev libcgal-dev libcli11-dev libglm-dev libstb-dev libtinygltf-dev libxxhash-dev nlohmann-json3-dev
          libvulkan-dev)
[ ! -s "$build/npm/meshlode.wasm" ] || packages+=(wasi-libc libc++-14-dev-wasm32 libclang-rt-14-dev-wasm32)
# package_of FILE: dpkg knows it below / or below /usr
package_of() {
  local path
  path=$(realpath "$1")
  dpkg-query -S "$path" 2>/dev/null || dpkg-query -S "${path#/usr}" 2>/dev/null || fail "no package has $path"
}
for library in $libraries; do
  name=$(basename "$library")
  case $name in
    ld-linux-* | libc.* | libm.* | libdl.* | libpthread.* | librt.* | libutil.* | libresolv.* | libstdc++.* | libgcc_s.*)
      name=libc/$name ;;  # of one age with the loader
  esac
  install -m 755 "$(realpath "$library")" "$folder/lib/$name"
  found=$(package_of "$library")
  packages+=("${found%%:*}")
done

# Licences: of the packages as Debian ships them, with the long texts that these name.
for package in "${packages[@]}"; do
  [ -e "/usr/share/doc/$package/copyright" ] || fail "no licence of $package"
  cp -L "/usr/share/doc/$package/copyright" "$folder/licences/libraries/$package.txt"
done
cp "$source/LICENSES/GPL-3.0-or-later.txt" "$source/LICENSES/MIT.txt" "$folder/licences/"
grep -rhoE '/usr/share/common-licenses/[A-Za-z]+(-[0-9.]*[0-9])?' "$folder/licences/libraries" | sort -u | while read -r text; do
  [ ! -e "$text" ] || cp -L "$text" "$folder/licences/libraries/"
done
{
  echo "What is inside, by Debian's packages. Their sources, by name and version, are in Debian's snapshot archive."
  echo
  printf '%s\n' "${packages[@]}" | sort -u |
    xargs dpkg-query -W -f '${Package} ${Version}, source ${source:Package} ${source:Version}\n'
} >"$folder/licences/LIBRARIES.txt"

cp "$build"/man/*.1 "$folder/share/man/man1/"
cp "$build/completions/meshlode" "$folder/share/bash-completion/completions/"
cp "$build/completions/_meshlode" "$folder/share/zsh/site-functions/"
cp "$build/completions/meshlode.fish" "$folder/share/fish/vendor_completions.d/"
cp "$source"/docs/schemas/*.json "$folder/share/meshlode/schemas/"
version=$(sed -n 's/^#define MESHLODE_VERSION_[A-Z]* \([0-9]*\) .*/\1/p' "$source/include/meshlode/version.h" | paste -sd .)
sed "s/@VERSION@/$version/" "$source/tools/package/package.json.in" >"$folder/package.json"
cp "$source/tools/package/README.md" "$folder/README.md"
echo "$folder: meshlode $version, $(find "$folder/lib" -type f | wc -l) libraries, $(du -sm "$folder" | cut -f 1) MB"
