#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# validate_exports.sh MESHLODE DATA: builds the scenes of data/ (and of MESHLODE_MODELS, where that is set), exports each
# as a cut, a fallback mesh, a camera's cut and LOD chains, and asks the Khronos validator. Any error fails.
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
# scene NAME FILE [BUILD OPTIONS]
scene() {
  local name=$1 file=$2; shift 2
  [ -f "$file" ] || { echo "FAILED: no $file"; failed=1; return; }
  "$meshlode" build "$file" -o "$work/$name.lode" --quiet "$@" || { echo "FAILED: build $file"; failed=1; return; }
  export_as "$name-finest" "$work/$name.lode" --level 0
  export_as "$name-lods" "$work/$name.lode" --lods 4
  case $name in
    rock) export_as rock-budget "$work/rock.lode" --triangles 1500
          export_as rock-camera "$work/rock.lode" --camera 3,2,4,0,0,0 --pixel-error 4 ;;
    city) export_as city-budget "$work/city.lode" --triangles 4000 --relative
          export_as city-errors "$work/city.lode" --lod-errors 0,0.001,0.01 --relative ;;
  esac
}
for name in rock city crystal foliage; do scene "$name" "$data/$name.glb"; done
if [ -n "${MESHLODE_MODELS:-}" ]; then
  models=$MESHLODE_MODELS
  scene helmet "$models/FlightHelmet/FlightHelmet.gltf"
  scene lamp "$models/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf"
  scene truck "$models/khronos/CesiumMilkTruck/glTF/CesiumMilkTruck.gltf"
  scene morph "$models/khronos/AnimatedMorphCube/glTF/AnimatedMorphCube.gltf"
  scene skin "$models/SimpleSkin/SimpleSkin.gltf"
  scene instances "$models/draco/SpheresScaledInstances/glTF/spheres_scaled_instances.gltf"
  scene spot "$models/spot.glb"
  scene duck "$models/khronos/Duck/glTF_Binary/Duck.glb"
  scene primitives "$models/GltfPrimitives/gltf_primitives.glb"
  scene colors "$models/draco/VertexColorTest/glTF/VertexColorTest.gltf"
  scene transform "$models/khronos/TextureTransformTest/glTF/TextureTransformTest.gltf"
  scene lights "$models/MixedLightingExample/MixedLightingExample.gltf"
  scene sheen "$models/khronos/SheenCloth/glTF/SheenCloth.gltf"
fi
"$node" "$here/validate_glb.js" "${made[@]}" | sed "s|$work/||" || failed=1
echo "${#made[@]} files"
[ $failed -eq 0 ] && echo PASSED
exit $failed
