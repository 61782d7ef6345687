# SPDX-License-Identifier: GPL-3.0-or-later
# stream: scenes and paths, their errors, and that neither threads nor outputs change what is said.
"$MESHLODE" build --quiet "$DATA/crystal.glb" -o crystal.lode --codec none --page-size 16
"$MESHLODE" build --quiet "$DATA/rock.glb" -o rock.lode --preset fast --page-size 16
# Bytes and errors are those of a build; what is counted here is not.
words() { sed -E 's/[0-9]+(\.[0-9]+)?/N/g; s/ +/ /g'; }
for path in fly walk turn teleport; do
  echo "\$ meshlode stream rock.lode --builtin $path --check"
  "$MESHLODE" stream rock.lode --builtin $path --check --fps 20 --pool all >out.txt; echo "exit $?"
  grep -E '^(path|picture|checked)' out.txt
done
echo "\$ meshlode stream rock.lode --pool all,1/2,0.001 --bandwidth 10 --latency 1,20"
"$MESHLODE" stream rock.lode --fps 20 --pool all,1/2,0.001 --bandwidth 10 --latency 1,20 | words
awk 'length > 80 { print "longer than 80 characters" }' out.txt
# A scene and a path of one's own.
printf 'rock.lode 0 0 0 0 1 # a rock\ncrystal.lode 5 0 0 45 0.5\nrock.lode 0 0 5 90 2\n' >scene.txt
printf 't,ex,ey,ez,tx,ty,tz\n0,0,2,20,0,0,0\n1,0,2,8,0,0,0,45\n1.5,9,2,8,5,0,0,cut\n2,9,2,7,5,0,0\n' >path.csv
stream() { "$MESHLODE" stream rock.lode crystal.lode --scene scene.txt --path path.csv --fps 20 --check --format json --log --jobs "$1"; }
stream 1 >one.json; echo "exit $?"
stream 4 >four.json
cmp one.json four.json && echo "the same for 4 threads"
"$MESHLODE" stream rock.lode crystal.lode --scene scene.txt --path path.csv --fps 20 --check --format json --log -o file.json --plot plot.svg
cmp one.json file.json && echo "the same in a file"
grep -c '<svg' plot.svg
tr -d ' \n' <one.json | grep -oE '"instances":[0-9]+|"frames":[0-9]+|"jumps":2|"finding_count":[1-9]' | sort -u
run stream rock.lode crystal.lode --scene scene.txt --path path.csv --quiet
# Pages of other builds are what these builds make: pages, working set, drawn share, first pages and their error.
"$MESHLODE" build --quiet "$DATA/rock.glb" -o small.lode --preset fast --page-size 32 --page-order covisible
"$MESHLODE" stream small.lode --fps 20 --layout try:16 | awk '$1 == "this" { print $3, $4, $6, $7, $8 }' >built.txt
"$MESHLODE" stream rock.lode --fps 20 --layout try:32/covisible,16/level/65536 >out.txt; echo "exit $?"
awk '$1 == "32/covisible" { print $2, $3, $5, $6, $7 }' out.txt | cmp - built.txt && echo "the same as a build's"
tail -n 5 out.txt | words
awk 'length > 80 { print "longer than 80 characters" }' out.txt
json stream stream rock.lode --fps 20 --layout try:32/covisible,16/level/65536 --format json
# What cannot be.
run stream rock.lode --layout 32
run stream rock.lode --layout try:
run stream rock.lode --layout try:48
run stream rock.lode rock.lode
run stream scene.txt
run stream rock.lode --pool 0
run stream rock.lode --pool 3/2
run stream rock.lode --pool 1,,2
run stream rock.lode --bandwidth 0
run stream rock.lode --latency -1
run stream rock.lode --fps 0
run stream rock.lode --near -1
run stream rock.lode --pixel-error 0
run stream rock.lode --size 0x10
run stream rock.lode --builtin dance
run stream rock.lode --log
run stream rock.lode --path path.csv --builtin walk
run stream rock.lode --pool 1,2,3,4,5,6,7,8,9,10 --bandwidth 1,2,3,4,5,6,7,8,9,10 --latency 1,2,3
printf 'stone.lode 0 0 0 0 1\n' >bad.txt
run stream rock.lode --scene bad.txt
printf 'rock.lode 0 0 0 0 1\n\nrock.lode 0 0 0 0\n' >bad.txt
run stream rock.lode --scene bad.txt
printf '0,0,0,1,0,0,0\n0,0,0,1,0,0,0\n' >bad.csv
run stream rock.lode --path bad.csv
printf '0,0,0,1,0,0,0\n1e9,0,0,1,0,0,0\n' >bad.csv
run stream rock.lode --path bad.csv
: >bad.csv
run stream rock.lode --path bad.csv
run stream rock.lode --path missing.csv
run stream missing.lode --path path.csv --builtin fly
run stream missing.lode --log
run stream rock.lode ./rock.lode
code stream rock.lode --scene rock.lode
run stream rock.lode -o rock.lode
run stream rock.lode --plot rock.png
# A page that is damaged is named, with its file.
printf 'x' | dd of=crystal.lode bs=1 seek=$(($(wc -c <crystal.lode) - 9)) conv=notrunc 2>/dev/null
"$MESHLODE" stream rock.lode crystal.lode 2>&1 | grep -o '^meshlode: crystal.lode: page '
files
