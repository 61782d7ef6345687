# SPDX-License-Identifier: GPL-3.0-or-later
# An image that only GPUs read (KTX2): carried through, named where a picture would need it, refused by --strict.
cat >leaf.gltf <<'GLTF'
{"asset":{"version":"2.0"},"extensionsRequired":["KHR_texture_basisu"],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"componentType":5126,"count":3,"type":"VEC2"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
"materials":[{"name":"leaf","alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
"textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}],
"images":[{"name":"leaf.ktx2","mimeType":"image/ktx2","uri":"data:image/ktx2;base64,q0tUWCAyMLsNChoK"}],
"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}
GLTF
code build leaf.gltf -o leaf.lode
run render leaf.lode -o leaf.png --size 32x32
run render leaf.lode -o strict.png --size 32x32 --strict
run render leaf.lode -o clusters.png --size 32x32 --view clusters --strict
code extract leaf.lode --error 0 -o cut.glb
grep -ao '"KHR_texture_basisu":{"source":0}' cut.glb
cp "$DATA/rock.glb" rock.glb
code build rock.glb -o rock.lode
code render rock.lode -o rock.png --size 32x32 --strict
files
