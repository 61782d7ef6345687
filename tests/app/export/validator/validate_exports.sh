#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# validate_exports.sh MESHLODE DATA: builds the scenes of data/ (and every .gltf and .glb below MESHLODE_MODELS, where that
# is set), each with the next of the codecs, exports each as its finest level, a fallback mesh and an LOD chain, two of
# them in other ways too, and asks the Khronos validator. Any error fails.
#   npm install --prefix DIR gltf-validator; MESHLODE_GLTF_VALIDATOR=DIR ctest -R Export.KhronosValidator
# Without MESHLODE_GLTF_VALIDATOR or Node it says so and exits 77, which ctest shows as skipped.
set -uo pipefail
meshlode=$(realpath "$1"); data=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
node=$(command -v node) || { echo "SKIPPED: no node"; exit 77; }
[ -n "${MESHLODE_GLTF_VALIDATOR:-}" ] || { echo "SKIPPED: MESHLODE_GLTF_VALIDATOR is not set"; exit 77; }
export NODE_PATH=$MESHLODE_GLTF_VALIDATOR/node_modules
[ -d "$NODE_PATH/gltf-validator" ] || { echo "SKIPPED: no gltf-validator in $NODE_PATH"; exit 77; }

work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
failed=0
made=()
# export_as NAME ASSET ARGS...
export_as() {
  local name=$1 asset=$2; shift 2
  if "$meshlode" extract "$asset" -o "$work/$name.glb" --quiet "$@"; then
    made+=("$work/$name.glb")
  else
    echo "FAILED: extract $name $*"; failed=1
  fi
}
codecs=(none strips)
scenes=0
# scene FILE
scene() {
  local file=$1 name codec=${codecs[$((scenes++ % ${#codecs[@]}))]} triangles
  name=$(basename "${file%.*}")-$codec
  "$meshlode" build "$file" -o "$work/$name.lode" --quiet --codec "$codec"
  case $? in
    0) ;;
    2|3|5) echo "refused: $file"; return ;;  # not ours to mend: a missing image, a node with two parents
    *) echo "FAILED: build $file"; failed=1; return ;;
  esac
  export_as "$name-finest" "$work/$name.lode" --level 0
  export_as "$name-lods" "$work/$name.lode" --lods 4
  export_as "$name-quantized" "$work/$name.lode" --level 0 --quantize
  # Of compressed data the validator sees the views alone; the importer's tests decode it.
  export_as "$name-compressed" "$work/$name.lode" --lods 3 --quantize --meshopt
  # A fallback of half the triangles, where the coarsest cuts have no more than that.
  triangles=$("$meshlode" info "$work/$name.lode" --format json | "$node" -e '
    const info = JSON.parse(require("fs").readFileSync(0, "utf8"));
    const roots = info.meshes.reduce((sum, mesh) => sum + mesh.root_triangles, 0);
    console.log(Math.max(roots, Math.floor(info.totals.source_triangles / 2)));')
  export_as "$name-budget" "$work/$name.lode" --triangles "$triangles"
  case $name in
    rock-*) export_as "$name-camera" "$work/$name.lode" --camera 3,2,4,0,0,0 --pixel-error 4 ;;
    city-*) export_as "$name-relative" "$work/$name.lode" --triangles 4000 --relative
            export_as "$name-errors" "$work/$name.lode" --lod-errors 0,0.001,0.01 --relative ;;
  esac
}
for file in "$data"/*.glb; do scene "$file"; done
if [ -n "${MESHLODE_MODELS:-}" ]; then
  while IFS= read -r file; do scene "$file"; done \
    < <(find -L "$MESHLODE_MODELS" -name '*.gltf' -o -name '*.glb' | LC_ALL=C sort)
fi
"$node" "$here/validate_glb.js" "${made[@]}" | sed "s|$work/||" || failed=1
echo "${#made[@]} files"
[ ${#made[@]} -ge 15 ] || { echo "FAILED: too few files"; failed=1; }
[ $failed -eq 0 ] && echo PASSED
exit $failed
