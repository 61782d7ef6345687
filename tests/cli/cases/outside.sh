# SPDX-License-Identifier: GPL-3.0-or-later
# A scene whose image lies in a folder beside its own: left out and named, read where the folder is allowed, by every
# verb that imports; depfile, cache and verify know the difference.
mkdir models textures
cat >models/s.gltf <<'GLTF'
{"asset":{"version":"2.0"},
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"images":[{"uri":"../textures/100%wood.png"},{"uri":"https://example.org/a.png"},{"uri":"C:\\tex\\a.png"},{"uri":""}],
"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}
GLTF
printf 'wood' >'textures/100%wood.png'
lacks() { "$MESHLODE" info "$1" --format json | grep -o '"its file [^,]*'; }
code build models/s.gltf -o without.lode
lacks without.lode
code build models/s.gltf -o strict.lode --strict
code build models/s.gltf -o with.lode --allow-outside textures --depfile with.d
lacks with.lode
cat with.d
code build models/s.gltf -o other.lode --allow-outside models --allow-outside models/../textures
cmp with.lode other.lode && echo same
code build --allow-outside textures models/s.gltf -o first.lode
code plan models/s.gltf --allow-outside textures
code doctor models/s.gltf --allow-outside textures
code verify with.lode --source models/s.gltf --quick --allow-outside textures
code verify without.lode --source models/s.gltf --quick
code verify with.lode --source models/s.gltf --quick
# The scene's own file is the same: the message says what may be another.
"$MESHLODE" verify with.lode --source models/s.gltf --quick | grep -o 'the source given is s.gltf.*' | sed -E 's/\([0-9a-f]+\)/(hash)/'
printf 'oak' >'textures/100%wood.png'
code verify with.lode --source models/s.gltf --quick --allow-outside textures
printf 'wood' >'textures/100%wood.png'
run build models/s.gltf -o none.lode --allow-outside nowhere
# What one run may not read, another's cache does not give it.
code build models/s.gltf -o a.lode --cache cache
cmp a.lode without.lode && echo same
code build models/s.gltf -o a.lode --cache cache --allow-outside textures
cmp a.lode with.lode && echo same
code build models/s.gltf -o a.lode --cache cache --strict
