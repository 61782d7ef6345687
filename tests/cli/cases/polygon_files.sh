# SPDX-License-Identifier: GPL-3.0-or-later
# PLY, OBJ and STL as their users write them: what is built, what is said to be left out, and --linear-colors, which the
# asset remembers.
# Sizes and times differ from one machine to the next.
build() { run build "$@" | sed -E 's/, [0-9,]+ bytes.*/, B bytes, S/'; }
ply() {
  printf 'ply\rformat ascii 1.0\relement vertex 4\rproperty float x\rproperty float y\rproperty float z\r'
  printf 'property uchar red\rproperty uchar green\rproperty uchar blue\rproperty float quality\r'
  printf 'element face 1\rproperty list uchar int vertex_indices\rend_header\r'
  printf '%s 188 100 50 1\r' '0 0 0' '1 0 0' '1 1 0' '0 1 0'
  printf '4 0 1 2 3\r'
}
ply >colors.ply
build colors.ply -o colors.lode
run verify colors.lode --source colors.ply --quiet
run build colors.ply -o linear.lode --linear-colors --quiet
run verify linear.lode --source colors.ply --quiet
run verify colors.lode --source colors.ply --linear-colors --quiet
json info info linear.lode --format json
"$MESHLODE" info linear.lode --format json | grep -o '"linear_colors": *true'
"$MESHLODE" info colors.lode --format json | grep -c linear_colors
json doctor doctor colors.ply --linear-colors --format json

# Two objects that stand apart, and two that touch: meshes and their names.
cat >objects.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
v 5 0 0
v 6 0 0
v 5 1 0
v 6 1 0
o left
f 1 2 3
o right
f 4 5 6
o more
f 5 7 6
OBJ
build objects.obj -o objects.lode
"$MESHLODE" info objects.lode --format json | grep -o '"name": *"[a-z]*"' | sort -u

# A facet count that is wrong.
{
  printf 'part%76s' ''
  printf '\7\0\0\0'
  printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0'
} >count.stl
build count.stl -o count.lode
run build --linear-colour count.stl -o no.lode
