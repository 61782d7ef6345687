# SPDX-License-Identifier: GPL-3.0-or-later
# --keep and --drop: by name, before what --attributes says; recorded where they change bytes, and there alone.
cp "$DATA/foliage.glb" a.glb
# What info says of attributes and of the settings that chose them.
tell() { "$MESHLODE" info "$1" | grep -E "^(kept|left out)"; "$MESHLODE" info "$1" --format json | tr -d ' \n' | grep -oE '"(keep|drop)":\[[^]]*\]' | LC_ALL=C sort; }
build() {
  code build --quiet a.glb -o "$@"
  tell "$1"
  code validate --quiet "$1"
  code verify --quiet --quick "$1" --source a.glb
}
build plain.lode
build dropped.lode --drop TEXCOORD_0
build kept.lode --keep all
build one.lode --attributes none --keep TEXCOORD_0
build but.lode --attributes all --drop NORMAL,TEXCOORD_0
code build --quiet a.glb -o same.lode --keep TEXCOORD_0,COLOR_0,TEXCOORD_3 --drop TEXCOORD_1
cmp plain.lode same.lode && echo "names that change nothing change nothing"
cp "$DATA/rock.glb" b.glb
code build --quiet b.glb -o smooth.lode --drop NORMAL --preset fast
tell smooth.lode
code verify --quiet --quick smooth.lode --source b.glb
run plan a.glb --keep NORMAL --drop TEXCOORD_0 | grep -A3 "mesh 0"
run build a.glb --keep NORMALS
run build a.glb --drop TANGENT
run build a.glb --keep NORMAL,COLOR_0 --drop COLOR_0
run plan a.glb --keep texcoord0
json info info kept.lode --format json
json info info dropped.lode --format json
rm -f ./*.lode
files
