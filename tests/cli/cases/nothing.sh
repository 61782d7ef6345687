# SPDX-License-Identifier: GPL-3.0-or-later
# An asset that draws nothing is never silent: a warning wherever a build is told of, a finding of doctor's, an error with
# --strict, which leaves nothing behind.
gltf() {  # FILE ATTRIBUTES: three corners on a line, as a triangle or otherwise
  cat >"$1" <<GLTF
{"asset":{"version":"2.0"},
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAQAAAAAAAAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,0,0]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}$2}]}],
"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}
GLTF
}
gltf flat.gltf ''
gltf lines.gltf ',"mode":3'
lines() { grep 'warning' ../told | sed 's/^  *//; s/   */ /g'; }
for scene in flat lines; do
  "$MESHLODE" build $scene.gltf -o $scene.lode 2>../told; echo "exit $?"; lines
  run doctor $scene.gltf --fail-on nothing-to-draw
  run doctor $scene.lode --fail-on nothing-to-draw
  rm $scene.lode
  run build $scene.gltf -o $scene.lode --strict
done
run build flat.gltf -o flat.lode --strict --repair
cp "$DATA/rock.glb" rock.glb
"$MESHLODE" build flat.gltf lines.gltf rock.glb -O out --report report.json --manifest manifest.json --junit junit.xml \
  --cache cache 2>../told
echo "exit $?"
lines | sed 's/; [0-9,]* triangles.*//'  # of each file, then the sum
grep -c '"id": "nothing-to-draw"' report.json manifest.json
grep -c 'warning: nothing to draw' junit.xml
json report build flat.gltf -o out/flat.lode --cache cache --format json
run build flat.gltf -o out/flat.lode --cache cache
run build flat.gltf -o out/flat.lode --cache cache --strict
run build flat.gltf -o out/flat.lode --cache cache --strict --dry-run
files | grep -v cache
