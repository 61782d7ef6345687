# SPDX-License-Identifier: GPL-3.0-or-later
# Every JSON document that the program prints is one the published schema accepts.
cp "$DATA/crystal.glb" a.glb
json report build a.glb --format json
code build --quiet a.glb -o a.lode --report report.json
"$JSON_CHECK" "$SCHEMAS/report.schema.json" <report.json
json info info a.lode --format json
json info info a.lode --format json --stuck
json validate validate a.lode --format json
json verify verify a.lode --source a.glb --format json
json report build missing.glb --format json
files
