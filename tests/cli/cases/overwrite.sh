# SPDX-License-Identifier: GPL-3.0-or-later
# No command writes over a file that it has read, under whatever name, nor over its own other output.
one='\000\000\200\077' zero='\000\000\000\000'
printf "$zero$zero$zero$one$zero$zero$zero$one$zero" >s.bin
printf 'no picture, but a file of the scene' >pic.png
printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"s.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"images":[{"uri":"pic.png"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}' >s.gltf
cp "$DATA/city.glb" a.glb
cp a.glb b.lode
ln -s s.bin link; ln s.bin hard; mkdir folder; ln -s .. folder/up
sums() { sha256sum s.gltf s.bin pic.png a.glb b.lode; }
sums >../before
for output in s.bin ./s.bin link hard folder/up/s.bin folder/../s.bin pic.png s.gltf "$PWD/s.gltf"; do
  code build --quiet s.gltf -o "$output" | sed "s|$PWD|.|"
done
for report in s.gltf s.bin hard link pic.png new.lode ./new.lode; do
  code build --quiet s.gltf -o new.lode --report "$report"
done
printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"s.bin","byteLength":37}]}' >bad.gltf
code build --quiet bad.gltf -o new.lode --report s.bin
code build --quiet b.lode
code build --quiet a.glb b.lode -O .
code build --quiet s.gltf -o s.lode --report report.json
sums | cmp - ../before && echo inputs untouched

ln -s a.lode alias.lode; ln a.lode twin.lode
cp a.glb gpu.json
sha256sum a.lode gpu.json >../before
for output in a.lode ./a.lode alias.lode twin.lode; do
  code render a.lode -o "$output" --size 16x16
  code extract a.lode --error 0.1 -o "$output"
  code extract alias.lode --stuck -o "$output"
done
code verify a.lode --source gpu.json --gpu --out-dir . --cuts 1 --cameras 1
printf '1 1 1 0 0 0\n' >path.txt
ln path.txt folder/gpu.json
code verify a.lode --source a.glb --gpu --path path.txt --out-dir folder --cuts 1 --cameras 1
sha256sum a.lode gpu.json | cmp - ../before && echo assets untouched
files
