# SPDX-License-Identifier: GPL-3.0-or-later
# What was given is named as what it is, with the command to use; what is wrong with a word is said with the nearest one.
cp "$DATA/rock.glb" rock.glb; cp "$DATA/crystal.glb" crystal.glb
code build --quiet rock.glb -o a.lode
echo "a scene where an asset is expected, and the other way round"
run info rock.glb
run render rock.glb -o x.png
run extract rock.glb --level 0 -o x.glb
run compare a.lode rock.glb
run validate rock.glb
run verify rock.glb --source crystal.glb
run verify rock.glb --source a.lode
run verify a.lode --source a.lode
run plan a.lode
run build a.lode
run build a.lode -o b.lode
run build a.lode -O out
run build a.lode -o b.lode --dry-run
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >t.obj; run info t.obj
printf '\xEF\xBB\xBF{"asset":{"version":"2.0"}}' >scene; run info scene; cp scene scene.json; run info scene.json
run verify scene --source a.lode
printf '\xEF\xBB\xBFply\rformat ascii 1.0\r' >cloud; run info cloud
for text in hello '{"a":1}'; do printf %s "$text" >h.txt; run info h.txt; run render h.txt -o x.png; done; printf LODE >h.txt; run info h.txt
rm scene scene.json cloud h.txt
echo "another scene than the one that the asset was built from"
run verify a.lode --source crystal.glb
run verify a.lode --source crystal.glb --quiet
json verify verify a.lode --source crystal.glb --format json
run verify a.lode --source crystal.glb --force --quick --quiet | grep -oE '^(V1[0-9]+|exit.*)' | LC_ALL=C sort -u
code verify a.lode --source rock.glb --quick
echo "empty files"
for name in e.glb e.gltf e.ply e.obj e.stl e.lode e.txt; do : >$name; run build $name -o x.lode; run info $name; rm $name; done
printf ' \n\t\n' >white.obj; run build white.obj -o x.lode; rm white.obj
echo "words"
run build rock.glb --codec strip
run build rock.glb --codec zstd
run build rock.glb --error-tier=certifed
run build rock.glb --codec gzip
run render a.lode -o x.png --view cluster
run man biuld
run buidl
run frobnicate
run build rock.glb -x
run build rock.glb --frobnicate
run build rock.glb -j many
run build rock.glb --jobs -1
run build rock.glb --jobs 1.5
run build rock.glb -o
run build rock.glb --max-memory
run build rock.glb -o a.lode -o b.lode
run build rock.glb --max-memory 1XB
run build rock.glb -o b.lode --max-memory 1MB
run build rock.glb -o b.lode --max-memory 1K
run info a.lode b.lode
run info a.lode --fail-if 'totals.frobnicate>1'
run doctor rock.glb --fail-on frobnicate | sed 's/; choose .*/; choose …/'
echo "short forms"
code build -q -j 1 rock.glb -o b.lode
code -V
code version
code help build
run help frobnicate
files
