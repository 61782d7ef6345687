#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# preloaded_test.sh MESHLODE PROBE LIBRARY DATA: assets that MESHLODE builds with LIBRARY preloaded are byte for byte those that it
# builds without (I10). That LIBRARY changes what it is to change, PROBE shows first.
set -euo pipefail
meshlode=$1 probe=$2 library=$3 data=$4
fail() { echo "FAILED: $*"; exit 1; }
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
[ "$("$probe")" != "$(LD_PRELOAD=$library "$probe")" ] || fail "$library changes nothing"
LD_PRELOAD=$library "$probe" | tail -n 2 | uniq | wc -l | grep -qx 1 || fail "$library does not reach other threads"
compared=0
# compare NAME SCENE OPTIONS...
compare() {
  local name=$1 scene=$2; shift 2
  "$meshlode" build --quiet "$scene" -o "$work/plain.lode" "$@"
  LD_PRELOAD=$library "$meshlode" build --quiet "$scene" -o "$work/preloaded.lode" "$@"
  cmp "$work/plain.lode" "$work/preloaded.lode" || fail "$name: other bytes"
  LD_PRELOAD=$library "$meshlode" validate --quiet "$work/plain.lode" || fail "$name: not valid"
  compared=$((compared + 1))
}
for scene in "$data"/*.glb; do compare "$(basename "$scene")" "$scene"; done
compare "rock, best" "$data/rock.glb" --preset best --codec strips
compare "rock, fast" "$data/rock.glb" --preset fast --codec strips
compare "terrain, certified" "$data/terrain.glb" --error-tier certified
compare "foliage, by coverage" "$data/foliage.glb" --aggregate auto
echo "$compared assets are equal"
