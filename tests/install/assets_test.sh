#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# assets_test.sh CMAKE BUILD_FOLDER COMPILER BATCH_MD: the CMake example of docs/guides/batches.md against an installed package, with
# each generator: what is built at first, that nothing is the second time, and which assets follow a change.
set -euo pipefail
cmake=$1 build=$2 compiler=$3 page=$4
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
"$cmake" --install "$build" --prefix "$work/prefix" >/dev/null
fail() { echo "FAILED: $*"; exit 1; }

# scene NAME: NAME.gltf of one triangle, NAME.bin and NAME.png
scene() {
  local one='\000\000\200\077' zero='\000\000\000\000'
  # shellcheck disable=SC2059
  printf "$zero$zero$zero$one$zero$zero$zero$one$zero" >"$1.bin"
  printf 'a picture' >"$1.png"
  printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"%s.bin","byteLength":36}],
"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"images":[{"uri":"%s.png"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],
"scenes":[{"nodes":[0]}],"scene":0}' "$(basename "$1")" "$(basename "$1")" >"$1.gltf"
}
for generator in Ninja "Unix Makefiles"; do
  project=$work/$generator
  mkdir -p "$project/scenes"
  scene "$project/scenes/hut"; scene "$project/scenes/tree"
  awk '/^```cmake/ { on = 1; next } /^```/ { on = 0 } on' "$page" >"$project/CMakeLists.txt"
  "$cmake" -S "$project" -B "$project/b" -G "$generator" -DCMAKE_PREFIX_PATH="$work/prefix" \
           -DCMAKE_CXX_COMPILER="$compiler" >/dev/null
  # built: which assets a build says it builds
  built() { "$cmake" --build "$project/b" | grep -o 'Building [a-z]*\.lode' | LC_ALL=C sort | tr '\n' ' '; }
  expect() { local got; got=$(built || true); [ "$got" = "$2" ] || fail "$generator: $1: '$got', not '$2'"; }
  expect "at first" "Building hut.lode Building tree.lode "
  "$work/prefix/bin/meshlode" validate --quiet "$project/b/assets/hut.lode" "$project/b/assets/tree.lode"
  expect "again" ""
  sleep 1.1  # of file times that have seconds alone
  printf 'A picture' >"$project/scenes/tree.png"
  expect "one byte of one texture" "Building tree.lode "
  expect "after it" ""
  rm "$project/scenes/hut.png"
  expect "a texture that is gone" "Building hut.lode "
  sleep 1.1
  printf 'a picture' >"$project/scenes/hut.png"
  expect "a texture that is there again" "Building hut.lode "
  expect "after it" ""
  sed -i 's/--codec none/--codec strips/' "$project/CMakeLists.txt"
  expect "another option" "Building hut.lode Building tree.lode "
  "$work/prefix/bin/meshlode" info "$project/b/assets/hut.lode" --format json | grep strips >/dev/null || fail "$generator: no strips"
  echo "$generator: as expected"
done
echo "PASSED"
