# SPDX-License-Identifier: GPL-3.0-or-later
# build --repair mends and counts each kind, the asset says so, and verify repairs the source in the same way.
cat >cube.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
v 0 0 1
v 1 0 1
v 0 1 1
v 1 1 1
v nan 0 0
v 0 0 0
f 1 3 2
f 2 3 4
f 5 6 7
f 6 8 7
f 1 2 5
f 2 6 5
f 3 7 4
f 4 7 8
f 10 5 3
f 3 5 7
f 2 6 4
f 4 6 8
OBJ
cp cube.obj broken.obj
cat >>broken.obj <<'OBJ'
f 1 2 9
f 1 2 99
f 1 10 2
f 4 2 3
f 2 4 3
OBJ
code build broken.obj -o broken.lode
"$MESHLODE" build broken.obj -o broken.lode --repair --report report.json 2>&1 | grep repaired
"$JSON_CHECK" "$SCHEMAS/report.schema.json" <report.json
tr -d ' \n' <report.json | grep -o '"repaired":{[^}]*}'
"$MESHLODE" info broken.lode --format json | tr -d ' \n' | grep -oE '"repair":(true|false)|"dropped":\{[^}]*\}' | head -n 2
code validate broken.lode
code verify broken.lode --source broken.obj --cuts 10 --cameras 3
echo "without --repair:"
sed -i '/nan/s/nan/5/; s/f 1 2 99/f 1 2 3/' broken.obj
code build broken.obj -o unrepaired.lode --report report.json
tr -d ' \n' <report.json | grep -o '"repaired":{[^}]*}'
code verify unrepaired.lode --source broken.obj --cuts 10 --cameras 3
code verify unrepaired.lode --source broken.obj --cuts 10 --cameras 3 --repair
files
