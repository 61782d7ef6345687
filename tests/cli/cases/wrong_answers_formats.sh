# SPDX-License-Identifier: GPL-3.0-or-later
# A file has the format that its name says or is not written, and a number beyond its range is refused: exit 1.
cp "$DATA/rock.glb" a.glb
code build --quiet a.glb -o a.lode
for name in x.jpg x.jpeg x.webp x.bmp x.gltf x.glb x.lode x.json; do run render a.lode -o $name; done
for name in x.gltf x.obj x.ply x.png; do run extract a.lode --error 0.1 -o $name; done
run extract a.lode --stuck -o x.gltf
for name in x.glb x.png x.zip; do run build a.glb -o $name; run repack a.lode -o $name --codec none; done
run build a.glb -o b.lode --manifest m.xml
run build a.glb -o b.lode --junit j.json
run build a.glb -o b.lode --report r.csv
run build a.glb -o b.lode --depfile d.json
# An extension that names no format is free, and so are none and capital letters.
for name in x x.PNG x.out; do code render --quiet a.lode -o $name --size 16x16; head -c 4 $name | tail -c 3; echo; done
for name in cut cut.GLB cut.part; do code extract --quiet a.lode --level 3 -o $name; head -c 4 $name; echo; done
code build --quiet a.glb -o a.asset
rm x x.* cut cut.* a.asset
echo "ranges"
run extract a.lode --level 99 -o z.glb
run extract a.lode --level 9 -o z.glb
code extract --quiet a.lode --level 8 -o z.glb
run extract a.lode --level -1 -o z.glb
for angle in 200 180.001 nan inf -1 5%; do
  run build a.glb -o b.lode --normal-error $angle
  run extract a.lode --error 1 --normal-error=$angle -o z.glb
done
echo '{"normal-error": 200}' >meshlode.json
run build a.glb -o b.lode
echo '{"meshes": {"*": {"normal-error": 181}}}' >meshlode.json
run build a.glb -o b.lode
rm meshlode.json
for fovy in 0 180 200 nan; do run render a.lode -o y.png --camera 0,0,5,0,0,0,$fovy; done
run render a.lode -o y.png --error nan
run render a.lode -o y.png --error -1
run render a.lode -o y.png --pixel-error -1
# A folder that is missing is made, for -o as for -O.
code build --quiet a.glb -o new/folder/a.lode --manifest new/told/m.json
code render --quiet a.lode -o pictures/a.png --size 16x16
code extract --quiet a.lode --level 8 -o cuts/a.glb
printf x >file
code build --quiet a.glb -o file/a.lode
files
