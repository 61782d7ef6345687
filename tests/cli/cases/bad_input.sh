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
# One vertex far away: beyond what the format holds it is refused, by plan too; before, what the grid lost is said.
for far in 1e37 1e30; do
  printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n%s 0 0\n0 0 0\n1 0 0\n0 1 0\n3 0 2 3\n3 1 2 3\n' $far >far.ply
  code plan far.ply
  code build far.ply -o far.lode
  sed -n 's/^meshlode: //p; /left out/p' ../stderr
done
"$MESHLODE" info far.lode | grep -E '^(flat|left out)'
rm far.lode far.ply
files
