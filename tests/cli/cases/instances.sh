# SPDX-License-Identifier: GPL-3.0-or-later
# EXT_mesh_gpu_instancing: three instances of a square are three nodes, in the asset and in what is extracted from it.
# The buffer: four positions, six indices of 16 bits, three translations.
cat >trees.gltf <<'GLTF'
{"asset":{"version":"2.0"},"extensionsRequired":["EXT_mesh_gpu_instancing"],
"buffers":[{"byteLength":96,"uri":"data:application/octet-stream;base64,BUFFER"}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},
{"buffer":0,"byteOffset":60,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}],
"meshes":[{"name":"square","primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"nodes":[{"name":"tree","mesh":0,"translation":[0,0,5],
"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2}}}}],
"scenes":[{"nodes":[0]}],"scene":0}
GLTF
one='\0\0\200\077' zero='\0\0\0\0' two='\0\0\0\100'
buffer=$(printf "$zero$zero$zero$one$zero$zero$one$one$zero$zero$one$zero"'\0\0\1\0\2\0\0\0\2\0\3\0'"$zero$zero$zero$two$zero$zero$zero$two$zero" |
  base64 -w 0)
sed -i "s|BUFFER|$buffer|" trees.gltf
instances() { "$MESHLODE" info "$1" --format json | tr -d ' \n' | grep -oE '"name":"tree[^"]*"|"transform":\[[^]]*\]'; }
code build trees.gltf -o trees.lode
instances trees.lode
code verify trees.lode --source trees.gltf
code extract trees.lode --error 0 -o cut.glb
code build cut.glb -o again.lode
instances again.lode
run render trees.lode -o trees.png --size 64x64 --pixel-error 1
sed 's/"count":3,/"count":4,/' trees.gltf >broken.gltf
run build broken.gltf -o x.lode
files
