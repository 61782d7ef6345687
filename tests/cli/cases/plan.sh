# SPDX-License-Identifier: GPL-3.0-or-later
# plan: what is kept of a scene and why, without building it.
for name in rock city foliage; do
  cp "$DATA/$name.glb" $name.glb
  run plan $name.glb
done
json plan plan rock.glb --format json
json plan plan city.glb --attributes none --format json
# Vertex colours alone: no texture is sampled, nothing is decoded for colours.
cat >colors.ply <<'END'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 2
property list uchar int vertex_indices
end_header
0 0 0 255 0 0
1 0 0 0 255 0
1 1 0 0 0 255
0 1 0 255 255 0
3 0 1 2
3 0 2 3
END
run plan colors.ply
run plan colors.ply --attributes none
run plan colors.ply --grid 1e-9
run plan missing.glb
files
