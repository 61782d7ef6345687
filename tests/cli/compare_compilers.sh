#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# compare_compilers.sh BUILD_A BUILD_B: builds the scenes of data/ (and a few models, where MESHLODE_MODELS names some)
# with both programs. Their content hashes, and the files' bytes, must be equal (I10), and so must the pictures of one
# program be as golden pictures to the other, and the page of a batch with its thumbnails.
set -euo pipefail
a=$1/meshlode b=$2/meshlode
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
scenes=("$(dirname "$0")"/../../data/*.glb)
if [ -n "${MESHLODE_MODELS:-}" ]; then
  for model in bunny spot; do
    [ -f "$MESHLODE_MODELS/$model.glb" ] && scenes+=("$MESHLODE_MODELS/$model.glb")
  done
fi
content_hash() { "$1" info "$2" --format json | sed -n 's/.*"content_hash": "\([0-9a-f]*\)".*/\1/p'; }
different=0 compared=0
for scene in "${scenes[@]}"; do
  name=$(basename "$scene" .glb)
  "$a" build --quiet "$scene" -o "$work/a.lode"
  "$b" build --quiet "$scene" -o "$work/b.lode"
  hash_a=$(content_hash "$a" "$work/a.lode") hash_b=$(content_hash "$b" "$work/b.lode")
  verdict=equal
  if [ -z "$hash_a" ] || [ "$hash_a" != "$hash_b" ]; then
    verdict=DIFFERENT different=$((different + 1))
  fi
  "$a" compare --golden "$work/$name" --update "$work/a.lode" --size 320x180 --quiet
  if ! "$b" compare --golden "$work/$name" "$work/a.lode" --size 320x180 --quiet; then
    verdict="PICTURES DIFFER" different=$((different + 1))
  fi
  compared=$((compared + 1))
  echo "$name  $hash_a  $hash_b  $verdict"
done
"$a" build --quiet "${scenes[@]}" -O "$work/out" --manifest "$work/manifest.json"
for program in a b; do "${!program}" report "$work/manifest.json" -o "$work/$program.html"; done
cmp "$work/a.html" "$work/b.html" || different=$((different + 1))
echo "$compared scenes compared, $different differ"
[ "$compared" -gt 0 ] && [ "$different" -eq 0 ]
