# SPDX-License-Identifier: GPL-3.0-or-later
# Hints are stored on demand, and stay those of their groups when an asset gets another codec or other errors.
cp "$DATA/crystal.glb" a.glb
run build --quiet a.glb -o plain.lode --page-size 16
run build --quiet a.glb -o hinted.lode --page-size 16 --page-hints
hash_of() { "$MESHLODE" info "$1" --format json | grep -o '"content_hash": *"[0-9a-f]*"'; }
section_of() { "$MESHLODE" info "$1" --format json | tr -d ' \n' | grep -oE '"name":"PHNT"' || echo "no hints"; }
[ "$(hash_of plain.lode)" = "$(hash_of hinted.lode)" ] && echo same content
section_of plain.lode
section_of hinted.lode
run repack --quiet hinted.lode -o repacked.lode --codec none
run measure --quiet hinted.lode --source a.glb --error-tier certified -o measured.lode
run build --quiet a.glb -o certified.lode --page-size 16 --page-hints --error-tier certified
cmp measured.lode certified.lode && echo "what a build has"
for file in hinted repacked measured; do
  section_of $file.lode
  run validate --quiet $file.lode
done
