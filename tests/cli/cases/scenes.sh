# SPDX-License-Identifier: GPL-3.0-or-later
# build --scene: by name, by index, all of them; the asset says which, verify follows, and extract shows the same.
cat >scenes.gltf <<'GLTF'
{"asset":{"version":"2.0"},
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"nodes":[{"name":"sun","mesh":0},{"name":"moon","mesh":0},{"name":"house","mesh":0},
{"name":"ghost","mesh":0,"extensions":{"KHR_node_visibility":{"visible":false}}}],
"scenes":[{"name":"day","nodes":[0,2]},{"name":"night","nodes":[1,2,3]}],"scene":0}
GLTF
names() { "$MESHLODE" info "$1" --format json | tr -d ' \n' | grep -oE '"name":"(sun|moon|house|ghost)"|"scene":"[^"]*"'; }
for scene in day night 1 all; do
  echo "== $scene"
  "$MESHLODE" build scenes.gltf -o a.lode --scene $scene 2>&1 | grep 'left out'
  names a.lode
  code verify a.lode --source scenes.gltf
  code extract a.lode --error 0 -o cut.glb
  "$MESHLODE" build cut.glb -o again.lode --quiet
  names again.lode
done
"$MESHLODE" info a.lode --format json | "$JSON_CHECK" "$SCHEMAS/info.schema.json"
echo "== without"
code build scenes.gltf -o a.lode
names a.lode
run build scenes.gltf -o x.lode --scene dusk
run build "$DATA/rock.glb" -o x.lode --scene 7 2>&1 | sed "s|$DATA|DATA|"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >a.obj
run build a.obj -o x.lode --scene day
code build a.obj -o b.lode --scene all
files
