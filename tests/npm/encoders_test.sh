#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# encoders_test.sh MESHLODE: scenes written by the encoders that people use, of versions that run on Debian's node 18. What was
# stored without loss gives the content of the plain scene, the same numbers packed by another codec the same content, and
# what was quantized the same DAG within the input's own precision. Skipped, aloud, where npm or its registry is not there;
# with MESHLODE_REQUIRE_NPM=1 that is a failure.
# shellcheck disable=SC2086  # scenes are called as this file calls them
set -uo pipefail
program=$(realpath "$1")
data=$(cd "$(dirname "$0")/../.." && pwd)/data
unset MESHLODE_CACHE
skip() {
  [ "${MESHLODE_REQUIRE_NPM:-}" != 1 ] || { echo "FAILED: $*, and MESHLODE_REQUIRE_NPM=1"; exit 1; }
  echo "SKIPPED: $*"; exit 77
}
for tool in node npm python3; do
  command -v $tool >/dev/null || skip "no $tool (Debian: nodejs npm)"
done
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export npm_config_update_notifier=false NO_UPDATE_NOTIFIER=1
npm install --prefix tools --no-audit --no-fund --ignore-scripts gltfpack@0.25.0 @gltf-transform/cli@4.2.1 \
  >npm.log 2>&1 || { tail -n 5 npm.log; skip "npm cannot install the encoders"; }
npm install --prefix newer --no-audit --no-fund --ignore-scripts gltfpack@1.3.0 >npm.log 2>&1 ||
  { tail -n 5 npm.log; skip "npm cannot install the newer encoder"; }

failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
pack() { tools/node_modules/.bin/gltfpack "$@" >pack.log 2>&1 || { tail -n 3 pack.log; fail "gltfpack $*"; }; }
transform() { tools/node_modules/.bin/gltf-transform "$@" >pack.log 2>&1 || { tail -n 3 pack.log; fail "gltf-transform $*"; }; }
# describe NAME: the content hash of NAME.glb's asset, and one line of sizes: meshes, instances, then triangles and clusters
# by level, all meshes together.
describe() {
  if ! { "$program" build "$1.glb" -o "$1.lode" --quiet && "$program" validate "$1.lode" --quiet &&
         "$program" info "$1.lode" --format json >"$1.json"; }; then
    fail "$1"; return
  fi
  python3 - "$1.json" <<'END'
import json, sys
info = json.load(open(sys.argv[1]))
print(info["content_hash"])
built = [mesh for mesh in info["meshes"] if mesh["levels"]]
levels = {}
for mesh in built:
    for number, level in enumerate(mesh["levels"]):
        one = levels.setdefault(number, [0, 0])
        one[0] += level["triangles"]
        one[1] += level["clusters"]
print(len(built), sum(mesh["source_triangles"] for mesh in built), levels[0][0], levels[0][1],
      sum(one[1] for one in levels.values()), levels.get(1, [0, 0])[0])
END
}
# same A B: equal content
same() {
  [ "$(head -n 1 "$1.said")" = "$(head -n 1 "$2.said")" ] || { fail "$1 and $2 differ in content"; return; }
  echo "  $1 = $2"
}
# like A B PERCENT: the same meshes and source triangles; clusters and the first level's triangles within so much
like() {
  python3 - "$1.said" "$2.said" "$3" <<'END' || fail "$1 and $2 differ in shape"
import sys
one, two = (list(map(int, open(name).read().split("\n")[1].split())) for name in sys.argv[1:3])
worst = max(abs(a - b) / max(a, 1) for a, b in zip(one[2:], two[2:])) * 100
print(f"  {sys.argv[1][:-5]} and {sys.argv[2][:-5]}: at most {worst:.2f}% apart")
sys.exit(one[:2] != two[:2] or worst > float(sys.argv[3]))
END
}

scenes=(city rock)
cp "$data/city.glb" "$data/rock.glb" .
if [ -n "${MESHLODE_MODELS:-}" ]; then
  cp "$MESHLODE_MODELS/bunny.glb" . && scenes+=(bunny)
fi
for scene in "${scenes[@]}"; do
  echo "$scene"
  # gltfpack puts vertices and triangles in another order, in which no bytes are lost with -noq.
  pack -i $scene.glb -o $scene-noq.glb -noq -kn -km
  pack -i $scene.glb -o $scene-noq-c.glb -noq -c -kn -km
  pack -i $scene.glb -o $scene-noq-cc.glb -noq -cc -kn -km
  pack -i $scene.glb -o $scene-c.glb -cc -vp 16 -vt 16 -vn 16 -kn -km
  transform quantize $scene.glb $scene-quantized.glb
  transform meshopt $scene.glb $scene-meshopt.glb --level medium
  transform draco $scene.glb $scene-draco.glb
  transform draco $scene.glb $scene-sequential.glb --method sequential
  for way in "" -noq -noq-c -noq-cc -c -quantized -meshopt -draco -sequential; do
    describe "$scene$way" >"$scene$way.said"
  done
  same $scene-noq $scene-noq-c
  # city is animated: these two pack its rotations into fewer bits.
  match=same
  [ $scene != city ] || match=like
  $match $scene-noq $scene-noq-cc 0
  $match $scene-quantized $scene-meshopt 0
  like $scene $scene-noq 1
  like $scene $scene-c 3
  like $scene $scene-quantized 3
  like $scene $scene-draco 3
  like $scene-draco $scene-sequential 1
  # What extract packs, unpacked by another decoder: the finest level again.
  "$program" extract $scene.lode --level 0 --quiet -o $scene-plain.glb
  "$program" extract $scene.lode --level 0 --quiet --quantize --meshopt -o $scene-small.glb
  transform dequantize $scene-small.glb $scene-unpacked.glb
  ! grep -q EXT_meshopt_compression $scene-unpacked.glb || fail "$scene-unpacked.glb is still packed"
  for way in -plain -small -unpacked; do describe "$scene$way" >"$scene$way.said"; done
  like $scene-plain $scene-small 3
  like $scene-small $scene-unpacked 1
done

# Newer than Debian's libmeshoptimizer: by name, exit code 5.
newer/node_modules/.bin/gltfpack -i rock.glb -o newer.glb -cz >pack.log 2>&1 || { tail -n 3 pack.log; fail "the newer gltfpack"; }
said=$("$program" build newer.glb -o newer.lode --quiet 2>&1); status=$?
case "$status $said" in
  5*"version 1 of the vertex codec is not supported"*) echo "newer streams are refused by name" ;;
  *) fail "a newer stream: exit $status: $said" ;;
esac
[ ! -e newer.lode ] || fail "a refused scene left an asset"
[ $failures -eq 0 ] && echo "PASSED"
[ $failures -eq 0 ]
