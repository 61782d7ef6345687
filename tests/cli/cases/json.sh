# SPDX-License-Identifier: GPL-3.0-or-later
# Every JSON document that the program prints is one the published schema accepts.
cp "$DATA/city.glb" a.glb
json report build a.glb --format json
code build --quiet a.glb -o a.lode --report report.json
"$JSON_CHECK" "$SCHEMAS/report.schema.json" <report.json
json doctor doctor a.glb --format json
json doctor doctor a.lode --format json
json info info a.lode --format json
json info info a.lode --format json --stuck
json compare compare a.lode a.lode --format json --render --size 64x48
json validate validate a.lode --format json
json verify verify a.lode --source a.glb --cuts 10 --cameras 3 --format json
json verify verify a.lode --source a.glb --quick --format json
json render render a.lode -o a.png --size 64x48 --format json
json render render a.lode -o a.png --size 64x48 --ortho 3 --error 0.01 --relative --format json
json extract extract a.lode --error 0.01 --relative -o cut.glb --format json
json repack repack a.lode -o strips.lode --codec strips --format json
json measure measure a.lode --source a.glb --error-tier qem -o qem.lode --format json
json stream stream a.lode --format json --check --log --fps 10
json stream stream a.lode --format json --pool 0.001
json validate validate a.lode a.lode --format json
json report build missing.glb --format json
files
