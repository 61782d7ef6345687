# SPDX-License-Identifier: GPL-3.0-or-later
# Cuts, budgets and discrete chains as GLB; what does not make sense, or cannot be met, writes nothing.
cp "$DATA/rock.glb" a.glb
code build --quiet a.glb -o a.lode
code extract a.lode --error 0.01 --relative -o cut.glb
code extract a.lode --triangles 1000 -o budget.glb
code extract a.lode --lods 3 -o levels.glb
json extract extract a.lode --lods 3 -o levels.glb --format json
json extract extract a.lode --lod-errors 0,0.01 --relative -o errors.glb --format json
json extract extract a.lode --lod-ratios 1,0.2 --size 640x480 --pixel-error 2 -o ratios.glb --format json
run extract a.lode --stuck -o stuck.glb
json extract extract a.lode --stuck -o stuck.glb --format json
for words in --quantize --meshopt "--quantize --meshopt"; do
  # shellcheck disable=SC2086
  code extract a.lode --level 0 $words -o small.glb
  "$MESHLODE" build --quiet small.glb -o small.lode
  "$MESHLODE" info small.lode --format json | grep -m 1 '"source_triangles"'
done
"$MESHLODE" info a.lode --format json | grep -m 1 '"source_triangles"'
"$MESHLODE" build --quiet levels.glb -o again.lode && echo "a chain builds again"
echo "nothing is written from here on"
run extract a.lode -o x.glb
run extract a.lode --error 0.1 --triangles 5 -o x.glb
run extract a.lode --stuck --error 0.1 -o x.glb
run extract a.lode --stuck --meshopt -o x.glb
run extract a.lode --lods 0 -o x.glb
run extract a.lode --lods 17 -o x.glb
run extract a.lode --lod-ratios 0.5,0.5 -o x.glb
run extract a.lode --lod-ratios 2,1 -o x.glb
run extract a.lode --lod-errors 0.1,0 -o x.glb
run extract a.lode --lod-errors 0,x -o x.glb
run extract a.lode --lods 3 --relative -o x.glb
run extract a.lode --triangles 5 --by quadric -o x.glb
run extract a.lode --triangles 5 --normal-error 3 -o x.glb
run extract a.lode --error 0.1 --uv-error -1 -o x.glb
code extract a.lode --triangles 5 -o x.glb
files
