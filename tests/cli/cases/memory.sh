# SPDX-License-Identifier: GPL-3.0-or-later
# A build that needs more memory than it may take is refused before it begins, and the report says what it needs.
cp "$DATA/crystal.glb" a.glb
code build --quiet a.glb -o a.lode --max-memory 4GiB --report enough.json
"$JSON_CHECK" "$SCHEMAS/report.schema.json" <enough.json
code build a.glb -o b.lode --max-memory 1MiB --report small.json
grep -c 'a.glb: the build needs about .* of memory, .* of it for mesh 0 .*; 1MiB are allowed by --max-memory: allow more' ../stderr
"$JSON_CHECK" "$SCHEMAS/report.schema.json" <small.json
for report in enough small; do grep -cE '"memory_estimate_bytes": ?[1-9][0-9]{7}' $report.json; done
run build a.glb -o b.lode --max-memory 0
run build a.glb -o b.lode --max-memory lots
files
