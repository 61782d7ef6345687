# SPDX-License-Identifier: GPL-3.0-or-later
# What cannot be meant is refused before any work, and the message says what was got.
cp "$DATA/city.glb" a.glb
code build --quiet a.glb -o a.lode
cp a.lode ../kept.lode
echo "an empty name is none"
for option in -o --output -O --manifest --report --junit --depfile --cache --settings-root --allow-outside; do run build a.glb $option ''; done
run build a.glb --manifest=
run extract a.lode --level 0 -o ''
run repack a.lode --codec none -o ''
run render a.lode -o ''
run merge m.json -o ''
run info a.lode --html ''
run sweep a.glb -o ''
run build ''
run build a.glb '' -O out
run info ''
run build a.glb --preset ''
run build a.glb --max-memory ''
echo "what was got"
run extract a.lode --level 4294967296 -o x.glb
run extract a.lode --triangles 18446744073709551616 -o x.glb
run build a.glb --strict=maybe
run render a.lode -o x.png --camera zz
run render a.lode -o x.png --size 0x5
run build a.glb --shard 3/2
echo "formats"
for name in a.jpe a.heic a.ico a.jpg2 b.xyzw; do run render a.lode -o $name; done
for name in a.b3dm a.step a.mtl; do run extract a.lode --level 0 -o $name; done
run build a.glb -o a.b3dm
run build a.glb -O new --manifest m.xml --cache new-cache
[ -e new ] || [ -e new-cache ] && echo "made a folder"
run completion bash -o x.png
for name in x.tmp x.part x.2 tmp.Ab3dE; do code render --quiet a.lode -o $name --size 8x8; done
rm x.* tmp.*
code build --quiet a.glb -o a.lode --depfile d.txt
mkdir folder
run build a.glb -o folder
run build a.glb -O out --manifest folder
echo "a dry run refuses what the build refuses"
run build a.glb -o a.jpg --dry-run
run build a.glb -o b.lode --manifest m.xml --dry-run
run build a.glb -o b.lode --manifest a.glb --dry-run
run build a.glb -o b.lode --report b.lode --dry-run
run build a.glb -o folder --dry-run
code build --quiet a.glb -o b.lode --cache cache --aggregate none-has-it
run build a.glb -o b.lode --cache cache --aggregate none-has-it --strict --dry-run
rm -r cache b.lode
echo "help"
code help --help
code help build
code version --help
run help build extra
run version x
run --version x
echo "no manifest"
: >empty.obj
for name in a.glb a.lode empty.obj; do run merge $name -o o.json; done
printf 'what' >what.json
run merge what.json -o o.json
rm empty.obj what.json
: >meshlode.json
run build a.glb
rm meshlode.json
echo "a missing file that a scene names is not written over it for the time being"
mkdir s
printf 'mtllib a.json\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >s/a.obj
code build s/a.obj --quiet -o s/a.lode --manifest s/a.json
grep -E '"(complete|status|error)"' s/a.json
files
