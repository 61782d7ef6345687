# SPDX-License-Identifier: GPL-3.0-or-later
# A tree in one mesh: its leaves are a mesh of the asset, and for all that names or compares meshes they are the tree's.
awk 'BEGIN {
  print "o tree\nusemtl bark"
  for (y = 0; y <= 24; y++) for (k = 0; k < 24; k++) {
    a = k * 0.2617993877991494
    printf "v %.6f %.6f %.6f\n", 0.1 * cos(a), y / 12, 0.1 * sin(a)
  }
  for (y = 0; y < 24; y++) for (k = 0; k < 24; k++) {
    i = 24 * y + k + 1; j = 24 * y + (k + 1) % 24 + 1
    print "f", i, i + 24, j + 24, j
  }
  print "usemtl leaf"
  n = 600
  for (k = 0; k < 600; k++) {
    x = (k * 37 % 101) / 50 - 1.01; y = 1.5 + (k * 53 % 97) / 100; z = (k * 71 % 103) / 50 - 1.03
    c = 0.03 * cos(k); s = 0.03 * sin(k)
    printf "v %.6f %.6f %.6f\nv %.6f %.6f %.6f\nv %.6f %.6f %.6f\nv %.6f %.6f %.6f\n", \
           x - c, y, z - s, x + c, y, z + s, x + c - s, y + 0.05, z + s + c, x - c - s, y + 0.05, z - s + c
    print "f", n + 1, n + 2, n + 3, n + 4
    n += 4
  }
}' >tree.obj
run plan --quiet tree.obj --aggregate auto | grep -o "mesh 0 .*aggregate: .*"
code build --quiet tree.obj -o tree.lode --aggregate auto
code build --quiet tree.obj -o whole.lode
code verify --quiet tree.lode --source tree.obj
run info tree.lode | grep -A4 "^mesh "
json info info tree.lode
run extract tree.lode --error 0 -o again.glb
run extract tree.lode --error 0 --mesh tree -o again.glb
run extract tree.lode --error 0 --mesh 1 -o leaves.glb
code build --quiet again.glb -o again.lode --aggregate auto
run info again.lode | grep "^mesh "
run compare whole.lode tree.lode | grep -E "^mesh|^ +(meshes|instances|source_triangles) |only"
json compare compare whole.lode tree.lode
