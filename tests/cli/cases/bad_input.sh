# SPDX-License-Identifier: GPL-3.0-or-later
# A missing file is 2, a broken one 3; one line names the file, and nothing is left behind.
code build missing.glb -o missing.lode
code info missing.lode
printf 'this is no scene' >noise.glb
printf '{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":7}}]}]}' >index.gltf
printf '{"asset":{"version":"2.0"},"extensionsRequired":["NOBODY_knows_this_geometry"],"extensionsUsed":["NOBODY_knows_this_geometry"]}' >extension.gltf
printf '' >empty.glb
for file in noise.glb index.gltf empty.glb extension.gltf; do
  code build "$file" -o out.lode
  grep -c "$file" ../stderr
done
printf 'this is no asset' >noise.lode
code info noise.lode
grep -c "noise.lode" ../stderr
mkdir folder.lode
code info folder.lode
code build noise.glb -o noise.glb
cat noise.glb; echo
files
