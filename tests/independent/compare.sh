#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# compare.sh MESHLODE CANONICAL_DUMP FUZZ_SEEDS STORE_BY DATA: builds golden files and asks both readers for every integer in them.
# Then bytes are changed behind their checksums, and both must refuse the same files (differ.py; STRIDE=1 for every byte).
set -uo pipefail
meshlode=$(realpath "$1"); dump=$(realpath "$2"); seeds=$(realpath "$3"); store_by=$(realpath "$4"); data=$(realpath "$5")
here=$(dirname "$(realpath "$0")")
python=$(command -v python3) || { echo "SKIPPED: no python3"; exit 77; }
export PYTHONDONTWRITEBYTECODE=1
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work" || exit 2
"$seeds" seeds || exit 2
cp seeds/reader/*-none.lode seeds/reader/*-lz4.lode seeds/reader/*-strips.lode .
for name in rock city crystal foliage; do
  "$meshlode" build "$data/$name.glb" -o "$name.lode" --codec none --aggregate never --quiet || exit 2
done
for promise in texels appearance; do
  "$meshlode" build "$data/foliage.glb" -o "foliage-$promise.lode" --promise $promise --codec none --aggregate never --quiet || exit 2
done
long=${STRIDE:+crystal}  # of the label slow: its builds take as long as all others
"$meshlode" build "$data/${long:-city}.glb" -o hints.lode --page-hints --page-size 16 --aggregate never --quiet || exit 2
for codec in none strips; do
  "$meshlode" build "$data/foliage.glb" -o "aggregate-$codec.lode" --aggregate auto --codec $codec --quiet || exit 2
done
"$store_by" lz4 rock.lode rock-lz4.lode || exit 2
for name in ${long:-city} foliage; do
  "$meshlode" build "$data/$name.glb" -o "$name-strips.lode" --aggregate never --quiet || exit 2
done
failed=0 count=0
for file in *.lode; do
  if ! "$dump" "$file" >cpp.txt || ! "$python" "$here/lode.py" "$file" >python.txt; then
    echo "FAILED: $file cannot be read"; failed=1; continue
  fi
  if cmp -s cpp.txt python.txt; then
    echo "$file: $(wc -c <"$file") bytes, $(wc -l <cpp.txt) lines agree"
    count=$((count + 1))
  else
    echo "FAILED: $file"; diff cpp.txt python.txt | head -n 6; failed=1
  fi
done
[ "$count" -ge 19 ] || { echo "FAILED: only $count files"; failed=1; }
# Bytes changed, checksums made to fit: the line between what a file may say and what not is the same for both.
"$python" "$here/differ.py" "$dump" tetrahedron-none.lode "${STRIDE:-37}" || failed=1
"$python" "$here/differ.py" "$dump" patch-none.lode $((${STRIDE:-37} * 19)) || failed=1
for codec in lz4 strips; do
  "$python" "$here/differ.py" "$dump" patch-$codec.lode $((${STRIDE:-37} * 19)) || failed=1
done
# Version 2: 256 quads, an aggregate of two levels.
awk 'BEGIN { for (k = 0; k < 256; ++k) { x = k % 16; y = int(k / 16); z = k * 7 % 11 / 5
  printf "v %g %g %g\nv %g %g %g\nv %g %g %g\nv %g %g %g\n", x, y, z, x + 0.7, y, z, x + 0.7, y + 0.8, z + 0.2, x, y + 0.8, z + 0.2
  printf "f %d %d %d %d\n", 4 * k + 1, 4 * k + 2, 4 * k + 3, 4 * k + 4 } }' >cards.obj
"$meshlode" build cards.obj -o cards.out --aggregate always --codec none --quiet || exit 2
[ "$(od -An -tu4 -j4 -N4 cards.out)" -eq 2 ] || { echo "FAILED: no aggregate"; failed=1; }
"$python" "$here/differ.py" "$dump" cards.out $((${STRIDE:-37} * 5)) || failed=1
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >triangle.obj
"$meshlode" build triangle.obj -o triangle.out --grid 1 --codec none --quiet || exit 2
"$python" "$here/hex_dump.py" "$here/../../docs/reference/format.md" triangle.out || failed=1
"$meshlode" build triangle.obj -o hinted.out --grid 1 --codec none --page-hints --quiet || exit 2
"$python" "$here/differ.py" "$dump" hinted.out "${STRIDE:-37}" || failed=1
# What it cannot read it says so.
for codec in zstd draco; do
  "$python" "$here/lode.py" "seeds/reader/scene-$codec.lode" >/dev/null 2>refused.txt
  [ $? -eq 5 ] || { echo "FAILED: $codec is not refused as unsupported"; failed=1; }
done
[ $failed -eq 0 ] && echo PASSED
exit $failed
