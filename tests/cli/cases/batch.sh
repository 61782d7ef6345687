# SPDX-License-Identifier: GPL-3.0-or-later
# A batch goes on after a failure and exits with its worst code; folders are scanned, their inner structure is kept.
mkdir -p in/deep
cp "$DATA/city.glb" in/one.glb
cp "$DATA/city.glb" in/deep/two.GLB
printf 'broken' >in/broken.glb
printf 'not a scene' >in/readme.txt
printf 'solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n' >in/one.stl
code build --quiet in -O out
code build --quiet in/one.glb missing.glb -O out2
code build --quiet in/one.glb in/deep/two.GLB -O out3
run build in
mkdir nothing
run build nothing -O out4
files
