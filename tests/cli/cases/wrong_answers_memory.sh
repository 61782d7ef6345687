# SPDX-License-Identifier: GPL-3.0-or-later
# Where there is no memory the exit code is 4 or the work is done, with one line and nothing left behind: never an abort, whichever
# allocation it is that fails. The scene's JSON is what is large: a list of a million numbers that is carried through.
head -c 2000000 /dev/zero | tr '\0' '0' | sed 's/0\(0\)/\1,/g' >zeros
{ printf '{"asset":{"version":"2.0"},"extras":['; cat zeros
  printf '0],"buffers":[{"uri":"b.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}'
} >x.gltf
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0' >b.bin
cp "$DATA/city.glb" city.glb
code build --quiet x.gltf -o x.lode
ulimit -c 0
done_in=0 refused=0
try() {
  local status
  ( ulimit -v "$limit"; exec "$MESHLODE" "$@" ) >../stdout 2>../stderr; status=$?
  case $status in
    0) done_in=$((done_in + 1)) ;;
    4) refused=$((refused + 1)); [ "$(grep -c '^meshlode: .*memory' ../stderr)" = 1 ] || { echo "$limit: $*: no line"; cat ../stderr; } ;;
    *) echo "$limit: $*: exit $status"; head -3 ../stderr ;;
  esac
}
"$MESHLODE" info x.lode >/dev/null
for limit in $(seq 60000 20000 300000); do
  try build --quiet x.gltf -o y.lode --jobs 1
  try build --quiet x.gltf -o y.lode --jobs 2 --aggregate auto
  try build --quiet city.glb -o y.lode --jobs 16
  try plan x.gltf
  try info x.lode
  try render --quiet x.lode -o x.png --size 16x16
  try extract --quiet x.lode --level 0 -o y.glb
  try verify --quiet x.lode --source x.gltf --quick
done
[ $done_in -gt 0 ] && [ $refused -gt 0 ] && echo "some were refused, some were done"
# Many threads share what addresses there are: none is refused what the others reserved.
for limit in 200000 250000 300000 400000; do
  ( ulimit -v $limit; exec "$MESHLODE" build --quiet city.glb -o y.lode --jobs 16 ) && echo "16 threads under $limit KiB"
done
rm -f y.lode x.png y.glb
files
