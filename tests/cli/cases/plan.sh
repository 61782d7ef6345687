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
# The same error of a build names the file too.
run build colors.ply -o grid.lode --grid 1e-9
run plan missing.glb
# Measured: the bytes are the builds' own; times vary.
json plan plan colors.ply --measure --format json
"$MESHLODE" build --quiet city.glb -o planned.lode
"$MESHLODE" build --quiet city.glb -o all.lode --attributes all --keep all
"$MESHLODE" plan city.glb --measure >measured.txt 2>/dev/null
for name in planned all; do wc -c <$name.lode; done | tr '\n' ' ' >bytes.txt
sed -n 's/,//g; s/^  file bytes *\([0-9]*\) *\([0-9]*\) .*/\1 \2 /p' measured.txt | tr -d '\n' | cmp - bytes.txt && echo "bytes are those of the builds"
grep -cE "^  (build, seconds|frame of the CPU, ms) +[0-9.]+ +[0-9.]+ " measured.txt
VK_DRIVER_FILES=/dev/null "$MESHLODE" plan colors.ply --measure | grep "same content"
rm -f ./*.lode ./*.txt
# --explain: the lines of plan on stderr, where the verb acts by it.
run plan foliage.glb >plan.txt
"$MESHLODE" build foliage.glb -o a.lode --explain --quiet 2>explained.txt
sed -n '/^settings/,/^passes/p' plan.txt | grep -v '^passes' >expected.txt
tail -n +2 explained.txt | cmp - expected.txt && echo "build explains what plan says"
run render a.lode -o a.png --size 64x48 --explain --quiet
run render a.lode -o a.png --size 64x48 --view clusters --explain --quiet | grep -E "^  (alpha-mask|textures)"
"$MESHLODE" verify a.lode --source foliage.glb --quick --quiet --explain 2>&1 | head -2
rm -f ./*.lode ./*.txt ./*.png
files
