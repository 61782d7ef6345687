# SPDX-License-Identifier: GPL-3.0-or-later
# A batch: patterns, what is told (lines, table, JSON, JUnit, manifest, depfile), --fail-fast, and a bar on a terminal.
one='\000\000\200\077' zero='\000\000\000\000'
# scene NAME: NAME.gltf of one triangle, NAME.bin and NAME.png
scene() {
  printf "$zero$zero$zero$one$zero$zero$zero$one$zero" >"$1.bin"
  printf 'a picture' >"$1.png"
  printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"%s.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"images":[{"uri":"%s.png"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}' \
    "$(basename "$1")" "$(basename "$1")" >"$1.gltf"
}
# Seconds are the machine's, and what an asset weighs is not asked here.
timeless() {
  sed -E -e 's/, [0-9,]+ bytes, [0-9]+\.[0-9]+ s$/, B bytes, S/' \
    -e 's/^([a-z]* +[0-9]*) +[0-9,]* +[0-9]+\.[0-9]{2}  /\1 B S  /' -e 's/time="[0-9.]+"/time="S"/' \
    -e 's/"((processor_)?seconds)": [0-9.e-]+/"\1": 0/' -e 's/"peak_memory_bytes": [0-9]+/"peak_memory_bytes": M/' -e 's/"program": "[0-9a-f]{32}"/"program": "P"/' \
    -e 's/^      "hash": "[0-9a-f]{32}"/      "hash": "H"/' -e 's/^      "bytes": [1-9][0-9]*/      "bytes": B/'
}
mkdir -p in/deep
scene in/a; scene in/b; scene in/deep/c
printf 'broken' >in/deep/broken.glb
rm in/b.png
run build 'in/**/*.gl*' -O out --junit junit.xml --manifest manifest.json --depfile assets.d --report report.json | timeless
timeless <junit.xml
"$JSON_CHECK" "$SCHEMAS/manifest.schema.json" <manifest.json
"$JSON_CHECK" "$SCHEMAS/report.schema.json" <report.json
timeless <manifest.json | sed -n '/"assets"/,/"in\/deep/p'
cat assets.d
echo "fail fast"
run build in/deep/broken.glb in/a.gltf -O fast --fail-fast | timeless
run build in/b.gltf -o b.lode --strict
run build 'in/*.ply' -O out
run build in/a.gltf -o a.lode --junit out/x --depfile out/../out/x
run build in/a.gltf -o a.lode --manifest a.lode
ln -s in/a.png a.d
run build in/a.gltf -o a.lode --depfile a.d
run build in/a.gltf --cache-limit much
mkdir -p out && code verify out/b.lode --source in/b.gltf --cuts 1 --cameras 1
# A terminal of its own: a bar for the whole batch, one line a file.
script -qec "'$MESHLODE' build in/a.gltf in/b.gltf -O bar" /dev/null >../typed </dev/null
echo "bars: $(tr '\r' '\n' <../typed | grep -c '\[1/2\] a.gltf \[[#.]*\]') lines: $(tr '\r' '\n' <../typed | grep -c 'triangles\? in 1 mesh')"
files
