# SPDX-License-Identifier: GPL-3.0-or-later
# Skinned meshes stand where their joints put them: "rigid" by one matrix (half its size, 5 to the right), "bent" vertex
# by vertex. Their nodes, at x = 50, say nothing, and extract writes both where they stand.
cat >skinned.gltf <<'GLTF'
{"asset":{"version":"2.0"},
"buffers":[{"byteLength":236,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAADIQgAAAAAAAAAAAAAAAAAAyEIAAAAAAAAAAAAAAAAAAAAAAAAAAAEAAAABAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAAAAPwAAAAAAAAAAAAAAAAAAAAAAAAA/AAAAAAAAAAAAAAAAAAAAAAAAAD8AAAAAAAAAAAAAAAAAAAAAAACAPwAAAD8AAAAAAAAAAAAAAAAAAAAAAAAAPwAAAAAAAAAAAAAAAAAAAAAAAAA/AAAAAAAAAAAAAAAAAAAAAAAAgD8="}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},
{"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":48},
{"buffer":0,"byteOffset":108,"byteLength":128}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[100,100,0]},
{"bufferView":1,"componentType":5121,"count":3,"type":"VEC4"},{"bufferView":2,"componentType":5121,"count":3,"type":"VEC4"},
{"bufferView":3,"componentType":5126,"count":3,"type":"VEC4"},{"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"}],
"meshes":[{"name":"r","primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":3}}]},
{"name":"b","primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3}}]}],
"skins":[{"joints":[2,3],"inverseBindMatrices":4}],
"nodes":[{"name":"rigid","mesh":0,"skin":0,"translation":[50,0,0]},{"name":"bent","mesh":1,"skin":0,"translation":[50,0,0]},
{"translation":[5,0,0]},{"translation":[5,0,7]}],
"scenes":[{"nodes":[0,1,2,3]}],"scene":0}
GLTF
code build skinned.gltf -o skinned.lode
code verify skinned.lode --source skinned.gltf --quick
"$MESHLODE" info skinned.lode --format json | grep -o '"skin 0".*pose[^"]*'
code extract skinned.lode --level 0 -o skinned.glb
grep -ao '"nodes":\[.*\],"s' skinned.glb
grep -ao '"max":[^]]*],"min":[^]]*]' skinned.glb
code build skinned.glb -o again.lode
code verify again.lode --source skinned.glb --quick
