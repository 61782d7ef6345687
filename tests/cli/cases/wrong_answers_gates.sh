# SPDX-License-Identifier: GPL-3.0-or-later
# Exit codes that a script goes by: budgets over counts that are absent, names that nothing has, names that a depfile cannot
# hold, what stays with --quiet, and a reader that has enough.
cp "$DATA/rock.glb" a.glb
code build --quiet a.glb -o a.lode
echo "counts"
run info a.lode --quiet --fail-if 'any(meshes).stuck_reasons["locked"]>0'
run info a.lode --quiet --fail-if 'any(meshes).stuck_reasons.topology!=0'
run info a.lode --quiet --fail-if 'any(meshes).stuck_reasons["locked"]==0'
run info a.lode --quiet --fail-if 'any(meshes).stuck_reasons["lokced"]>0'
run info a.lode --quiet --fail-if 'any(meshes).stuck_reason["locked"]>0'
run build --quiet a.glb -o b.lode --fail-if 'any(meshes).stuck_reasons["locked"]>0'
run info a.lode --quiet --fail-if 'file_bytes>1GB, file_bytes<100KB'
echo "names"
told() { run "$@" | sed -E 's/, [0-9,]+ bytes.*//'; }
told build a.glb -o b.lode --aggregate elm
run build a.glb -o c.lode --aggregate elm --strict
run build --quiet a.glb -o b.lode --aggregate elm
run build --quiet a.glb -o b.lode --aggregate 'rock,elm' --strict
run build --quiet a.glb -o b.lode --aggregate rock --strict
# What the cache has from a run that was not strict is no way around it.
code build --quiet a.glb -o d.lode --aggregate elm --cache cache
run build --quiet a.glb -o d.lode --aggregate elm --cache cache --strict
rm -r cache
echo "depfiles"
cp a.glb $'two\nlines.glb'
run build $'two\nlines.glb' -o e.lode --depfile e.d
run build a.glb -o $'e\n.lode' --depfile e.d
printf '{"asset":{"version":"2.0"},"images":[{"uri":"p%%0Aq.png"}],"buffers":[{"uri":"b.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]}' >n.gltf
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0' >b.bin
run build --quiet n.gltf -o e.lode --depfile e.d
code build --quiet $'two\nlines.glb' -o e.lode
echo "quiet"
lines() { echo "\$ meshlode $*: $("$MESHLODE" "$@" 2>../stderr | wc -l) line(s) on stdout, $(wc -l <../stderr) on stderr"; }
more() { [ "$("$MESHLODE" "$@" 2>../stderr | wc -l)" -gt 1 ] && echo "\$ meshlode $*: its report on stdout, $(wc -l <../stderr) line(s) on stderr"; }
lines build --quiet a.glb -o f.lode
more info --quiet a.lode
more info --quiet a.lode --format json
lines info --quiet a.lode --fail-if 'totals.meshes>5'
more plan --quiet a.glb
more compare --quiet a.lode b.lode
lines compare --quiet a.lode a.lode --fail-if 'file_bytes.change!=0'
lines doctor --quiet a.lode
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\n' >twice.obj
more doctor --quiet twice.obj
lines validate --quiet a.lode
lines verify --quiet a.lode --source a.glb --quick
lines render --quiet a.lode -o a.png --size 16x16
lines extract --quiet a.lode --level 8 -o cut.glb
lines repack --quiet a.lode -o h.lode --codec none
printf 'x' >noise.lode
lines validate --quiet noise.lode
lines info --quiet noise.lode
echo "a reader that has enough"
unread() {
  local status
  status=$( { { sleep 0.3; "$MESHLODE" "$@" 2>../stderr; echo $? >&3; } | true; } 3>&1 )
  echo "\$ meshlode $* | head: exit $status, $(wc -l <../stderr) line(s)"
}
unread info a.lode
unread info a.lode --format json
unread info a.lode --fail-if 'totals.meshes>0'
unread plan a.glb
unread doctor a.glb
unread compare a.lode a.lode
unread validate a.lode
unread validate noise.lode
unread verify a.lode --source a.glb --quick
unread completion bash
unread man build
unread --help
unread info nosuch.lode
