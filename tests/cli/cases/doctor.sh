# SPDX-License-Identifier: GPL-3.0-or-later
# doctor: what costs accuracy, bytes or time, worst first; exit 6 for what --fail-on names alone.
for name in rock terrain crystal foliage city; do
  cp "$DATA/$name.glb" $name.glb
  run doctor $name.glb
done
# A square of two triangles; then one of them again, once in either direction, one without area, and a line.
cat >square.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0.5 0.5 0
f 1 2 3
f 1 3 4
OBJ
cp square.obj broken.obj
cat >>broken.obj <<'OBJ'
f 2 3 1
f 2 1 3
f 1 5 3
l 1 2
OBJ
run doctor square.obj
run doctor square.obj --quiet
run doctor broken.obj
code doctor broken.obj --fail-on needles
code doctor broken.obj --fail-on needles,degenerate-faces
code doctor broken.obj --fail-on any
code doctor broken.obj --fail-on medium
code doctor broken.obj --fail-on left-out
code doctor square.obj --fail-on any,high
json doctor doctor broken.obj --format json --fail-on any
json doctor doctor rock.glb --format json
"$MESHLODE" doctor broken.obj --format json --fail-on any | tr -d ' \n' | grep -oE '"(id|failed_on)":[^,]*' | head -n 3
run doctor missing.glb
echo "no scene" >text.glb
code doctor text.glb
# Of an asset: what its tables say.
code build --quiet broken.obj -o broken.lode
run doctor broken.lode
code doctor broken.lode --fail-on dropped-faces
code doctor broken.lode --fail-on degenerate-faces
json doctor doctor broken.lode --format json
head -c 100 broken.lode >cut.lode
code doctor cut.lode
files
