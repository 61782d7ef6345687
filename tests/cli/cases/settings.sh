# SPDX-License-Identifier: GPL-3.0-or-later
# meshlode.json beside a scene and in folders above it: inherited downwards, the nearer wins, the command line before both.
mkdir -p in/deep
cp "$DATA/city.glb" in/city.glb
cp "$DATA/foliage.glb" in/deep/foliage.glb
# What an asset's settings say.
tell() { "$MESHLODE" info "$1" --format json | tr -d ' \n' | sed 's/.*"settings"://; s/,"totals".*//'; echo; }
echo '{"codec": "none", "normal-error": 0.5}' >in/meshlode.json
echo '{"codec": "strips", "drop": ["TEXCOORD_0"]}' >in/deep/meshlode.json
code build --quiet in -O out
tell out/city.lode
tell out/deep/foliage.lode
code verify --quiet --quick out/deep/foliage.lode --source in/deep/foliage.glb
code build --quiet in/deep/foliage.glb -o alone.lode
tell alone.lode
code build --quiet in/deep/foliage.glb -o rooted.lode --settings-root in
cmp rooted.lode out/deep/foliage.lode && echo "as from the folder"
code build --quiet in/deep/foliage.glb -o called.lode --codec none --keep TEXCOORD_0
tell called.lode
code build --quiet in/deep/foliage.glb -o plain.lode --no-settings-file
mv in/deep/meshlode.json in/deep/not.json
code build --quiet in/deep/foliage.glb -o usual.lode
cmp plain.lode usual.lode && echo "passed over"
# Settings of meshes by name and by glob.
echo '{"meshes": {"*": {"normal-error": 1}, "tower": {"position-error": 0.01, "error-tier": "qem"}}}' >in/meshlode.json
"$JSON_CHECK" "$SCHEMAS/settings.schema.json" <in/meshlode.json
"$MESHLODE" plan in/city.glb | sed -n '/^settings/,/^attributes/p'
code build --quiet in/city.glb -o meshes.lode
tell meshes.lode
code validate --quiet meshes.lode
code verify --quiet --quick meshes.lode --source in/city.glb
code build --quiet in/city.glb -o again.lode --jobs 1
cmp meshes.lode again.lode && echo "the same with one thread"
json plan plan in/city.glb --format json
json info info meshes.lode --format json
refuse() { printf '%s' "$1" >in/meshlode.json; run build in/city.glb -o no.lode; }
# What a study asks for is no setting and no option of build, and its asset says what it is.
code study --quiet --no-settings-file --error-tier qem --care needles=off,spheres=off in/city.glb -o study.lode
json info info study.lode --format json
"$MESHLODE" info study.lode | grep experimental
code validate --quiet study.lode
refuse '{"care": "needles=off"}'
run study in/city.glb -o no.lode --no-settings-file --care needels=off
run build in/city.glb -o no.lode --no-settings-file --care needles=off
# The example of docs/reference/settings.md is one.
sed -n '/^```json/,/^```$/p' "$REPOSITORY/docs/reference/settings.md" | grep -v '^```' >in/meshlode.json
"$JSON_CHECK" "$SCHEMAS/settings.schema.json" <in/meshlode.json
code plan in/city.glb
# What cannot be settings: exit 3, as any input that breaks its rules.
refuse '{"codecs": "zstd"}'
refuse '{"jobs": 1}'
refuse '{"codec": "gzip"}'
refuse '{"codec": "zstd"}'
refuse '{"grid": -1}'
refuse '{"grid": 1, "position-error": 1}'
refuse '{"keep": ["NORMALS"]}'
refuse '{"meshes": {"tower": {"preset": "fast"}}}'
refuse '{"meshes": {"tower": {"uv_error": 1}}}'
refuse '{"codec": '
refuse '[]'
run plan in/city.glb
code build --quiet in -O out2
# It was read: nothing is written over it.
echo '{}' >in/meshlode.json
ln -s in/meshlode.json link.lode
run build in/city.glb -o link.lode
rm -f ./*.lode
files
# What a use decides lies below every setting that is given, and has its own line in plan and build.
echo '{"for": "engine", "normal-error": 1}' >in/meshlode.json
"$JSON_CHECK" "$SCHEMAS/settings.schema.json" <in/meshlode.json
"$MESHLODE" build in/city.glb -o engine.lode 2>&1 | grep decided
tell engine.lode
"$MESHLODE" build in/city.glb -o given.lode --for archive --preset fast --error-tier measured 2>&1 | grep decided
tell given.lode
"$MESHLODE" plan in/city.glb --for web | sed -n '/^settings/,/^attributes/p'
echo '{"for": "engine"}' >in/meshlode.json
code build --quiet in/city.glb -o engine.lode --cache kept
code build --quiet in/city.glb -o by-hand.lode --no-settings-file --codec none --page-size 32 --page-order covisible --cache kept
cmp engine.lode by-hand.lode && echo "the same asset, and the same entry of the cache: $(ls kept/record | wc -l)"
run build in/city.glb -o x.lode --for engines
echo '{"meshes": {"*": {"for": "web"}}}' >in/meshlode.json
run build in/city.glb -o x.lode
