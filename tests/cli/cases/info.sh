# SPDX-License-Identifier: GPL-3.0-or-later
# info in its four forms, of a triangle whose names are markup everywhere; what a pipe is given is plain and the same for
# all, a terminal is given blocks where its locale has them.
cat >odd.gltf <<'GLTF'
{"asset":{"version":"2.0"},
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"materials":[{"name":"leaf|<b>*","alphaMode":"MASK","alphaCutoff":0.25,"doubleSided":true},{"name":"glass","alphaMode":"BLEND"}],
"meshes":[{"name":"a,\"b\"\n|<i>_c_","primitives":[{"attributes":{"POSITION":0},"material":0}]},
{"name":"pane","primitives":[{"attributes":{"POSITION":0},"material":1}]}],
"nodes":[{"mesh":0},{"mesh":1}],"scenes":[{"nodes":[0,1]}],"scene":0}
GLTF
code build --quiet odd.gltf -o odd.lode
run info odd.lode --format csv
run info odd.lode --format csv --stuck
# Levels and materials; the rest is numbers that any change of the format moves.
"$MESHLODE" info odd.lode --format markdown | sed '/^## Bytes/,$d' | grep -E '^(#|\| (leaf|glass|level|0 \|))'
"$MESHLODE" info odd.lode | sed '/^decoded pages/,$d' | grep -E '^(mesh|level|    0|    [01]  )'
json info info odd.lode --format json
# The columns of CSV are the keys of JSON.
cp "$DATA/crystal.glb" a.glb
code build --quiet a.glb -o a.lode
"$MESHLODE" info a.lode --format json | tr -d ' \n' | grep -o '"levels":\[{[^]]*\]' | head -1 | grep -o '"[a-z_]*":' | sort -u |
  tr -d '":' | grep -v levels >keys
"$MESHLODE" info a.lode --format csv | head -1 | tr , '\n' | grep -vE '^(mesh|name)$' | sort | diff - keys && echo "the same keys"
# A level a line.
levels=$("$MESHLODE" info a.lode --format json | grep -c '"full_clusters"')
[ "$("$MESHLODE" info a.lode --format csv | wc -l)" -eq $((levels + 1)) ] && echo "a line each"
# on LOCALE: which signs the bars of a terminal have. Errors have bars where there are no other deviations.
code build --quiet a.glb -o b.lode --attributes none
on() {
  echo "$1: $(env LC_ALL="$1" script -qec "'$MESHLODE' info b.lode" /dev/null | grep -oE '█|#' | sort -u | tr -d '\n')"
}
if command -v script >/dev/null; then
  on C.UTF-8; on en_GB.utf8; on C; on POSIX
fi
echo "pipe: $(LC_ALL=C.UTF-8 "$MESHLODE" info b.lode | grep -oE '█|#' | sort -u | tr -d '\n')"
