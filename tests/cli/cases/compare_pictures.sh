# SPDX-License-Identifier: GPL-3.0-or-later
# compare finds a changed texture, a moved vertex and a lost material by number and by picture: of two assets, of folders
# and manifests, and against golden pictures.
cat >make.py <<'END'
# make.py OUT.gltf [texture|vertex|material]: a plane of two materials, one with a chequered texture.
import base64, json, struct, sys, zlib
what = sys.argv[2] if len(sys.argv) > 2 else ""
n = 8
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
def png(spot):
    rows = b""
    for y in range(16):
        rows += b"\0" + b"".join(bytes([255, 0, 0] if spot and x < 6 and y < 6 else [220, 220, 220] if (x // 4 + y // 4) % 2 else [60, 90, 60]) for x in range(16))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 16, 16, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
points, uvs, left, right = b"", b"", b"", b""
for y in range(n + 1):
    for x in range(n + 1):
        lift = 1.5 if what == "vertex" and (x, y) == (2, 5) else 0.0
        points += struct.pack("<3f", x, y, lift); uvs += struct.pack("<2f", x / n, y / n)
for y in range(n):
    for x in range(n):
        a = y * (n + 1) + x
        quad = struct.pack("<6H", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1)
        if x < n // 2: left += quad
        else: right += quad
image = png(what == "texture")
parts = [points, uvs, left, right, image]
views, data = [], b""
for part in parts:
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part)})
    data += part + b"\0" * (-len(part) % 4)
count = (n + 1) ** 2
materials = [{"name": "chequered", "doubleSided": True, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
if what != "material": materials.append({"name": "blue", "doubleSided": True, "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.9, 1]}})
json.dump({"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
  "bufferViews": views, "images": [{"bufferView": 4, "mimeType": "image/png", "name": "chequer"}], "textures": [{"source": 0}], "materials": materials,
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3", "min": [0, 0, 0], "max": [n, n, 1.5]},
    {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC2"}] + [{"bufferView": v, "componentType": 5123, "count": n * n * 3, "type": "SCALAR"} for v in (2, 3)],
  "meshes": [{"name": "plane", "primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2 + i, "material": min(i, len(materials) - 1)} for i in (0, 1)]}],
  "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0}, open(sys.argv[1], "w"))
END
mkdir -p old/deep new/deep
for name in same texture vertex material; do python3 make.py old/deep/$name.gltf; python3 make.py new/deep/$name.gltf $name; done
for side in old new; do code build -q $side -O out-$side --manifest $side.json; done
# Differences to four digits: the rest is libm's.
run() { echo "\$ meshlode $*"; "$MESHLODE" "$@" 2>&1 | sed -E 's/(0\.[0-9]{4})[0-9]+/\1/'; echo "exit ${PIPESTATUS[0]}"; }
CAMERA='--size 96x64 --camera 4,4,11,4,4,0'
figures() { grep -vE '_bytes|bytes_|^  [A-Z]{4} +bytes' | sed -E 's/[0-9a-f]{32}/HASH/g'; }
for name in texture vertex material; do
  echo "\$ compare $name"
  "$MESHLODE" compare out-old/deep/$name.lode out-new/deep/$name.lode --render $CAMERA | figures
done
json compare compare out-old/deep/vertex.lode out-new/deep/vertex.lode --format json --render $CAMERA --camera 0,0,9,4,4,0 -O pair --fail-if 'flip.mean>0.02'
ls pair
# Numbers and pictures find each of them; nothing finds the one that is the same.
for condition in 'content_equal==false' 'flip.mean>0.005' 'any(pictures).differing_pixels>20' 'any(pictures).flip.max>0.1' 'count(materials_removed)>0' 'count(images_changed)>0'; do
  run compare out-old out-new --render $CAMERA --fail-if "$condition" --quiet
done
run compare out-old out-new --fail-if 'flip.mean>0.02'
run compare out-old out-new --fail-if 'any(pictures).flip.max>0.02'
json bulk compare out-old out-new --render $CAMERA -O folder --format json
(cd folder && find . -type f | LC_ALL=C sort)
grep -o '<td class="good">equal</td>\|<td>changed</td>\|src="[^"]*new.png"\|[0-9]* files[^<]*' folder/index.html
# Manifests: by scene, though both sides have other folders; what was changed since is not the asset of the manifest.
sed 's,"old/,"new/,' old.json >moved.json
run compare moved.json new.json --render $CAMERA --fail-if 'flip.mean>0.005' --quiet -O manifests
(cd manifests && find . -type f | LC_ALL=C sort)
cp out-new/deep/same.lode keep.lode; cp out-new/deep/texture.lode out-new/deep/same.lode
run compare moved.json new.json
cp keep.lode out-new/deep/same.lode
run compare old.json old.json
run compare old.json out-new
# An asset without an older one is opened too: one with a damaged page, one that is gone, and another than its manifest
# lists.
code build -q new/deep/same.gltf -O out-one --manifest one.json
cat >damage.py <<'END'
import sys
data = bytearray(open(sys.argv[1], "rb").read()); data[-20] ^= 1; open(sys.argv[2], "wb").write(data)
END
mkdir part; cp out-new/deep/same.lode part/
run compare out-one part --quiet; python3 damage.py out-new/deep/vertex.lode part/vertex.lode
run compare out-one part
run compare one.json new.json --quiet
mv out-new/deep/vertex.lode keep.lode; cp out-new/deep/same.lode out-new/deep/material.lode
run compare one.json new.json
run compare --golden pictures --manifest new.json --update --size 32x32 --quiet
cp keep.lode out-new/deep/vertex.lode; code build -q new/deep/material.gltf -o out-new/deep/material.lode
run compare --golden pictures part --update --size 32x32 --quiet
# Golden pictures.
run compare --golden golden out-old --update $CAMERA --camera 0,0,9,4,4,0
(cd golden && find . -type f | LC_ALL=C sort)
run compare --golden golden out-old $CAMERA --camera 0,0,9,4,4,0
run compare --golden golden out-new $CAMERA --camera 0,0,9,4,4,0 --quiet -O golden-changes --junit golden.xml
(cd golden-changes && find . -type f | LC_ALL=C sort)
grep -c '<failure' golden.xml
run compare --golden golden out-new $CAMERA --camera 0,0,9,4,4,0 --quiet --fail-if 'flip.mean>0.05'
json golden compare --golden golden/deep out-new/deep/vertex.lode $CAMERA --format json
json bulk compare --golden golden out-new --format json $CAMERA --camera 0,0,9,4,4,0
run compare --golden golden --manifest new.json --quiet $CAMERA --camera 0,0,9,4,4,0 --fail-if 'flip.mean>1'
"$MESHLODE" compare --golden golden out-new $CAMERA --camera 0,0,9,4,4,0 --jobs 1 >one.txt 2>&1
"$MESHLODE" compare --golden golden out-new $CAMERA --camera 0,0,9,4,4,0 --jobs 5 >five.txt 2>&1; cmp one.txt five.txt
# Assets that a pattern or a name leaves out are not missed, nor are other files there; -O stays away from it.
cp golden/deep/same.1.png golden/logo.png; cp golden/deep/same.1.png golden/deep/same.1.flip.png
set -f
for words in 'out-old/deep/[st]*.lode' 'out-old/deep/same.lode out-old/deep/texture.lode'; do
  run compare --golden golden/deep $words --quiet $CAMERA --camera 0,0,9,4,4,0
done
set +f
run compare --golden golden out-old --quiet $CAMERA --camera 0,0,9,4,4,0
code build -q old -O out-part --manifest shard.json --shard 1/2
run compare --golden golden/deep --manifest shard.json --quiet $CAMERA --camera 0,0,9,4,4,0
ln -s golden link; for folder in golden golden/ ./golden/deep/new link/x; do run compare --golden golden out-old -O $folder; done
# A picture of nothing, none, another size, and one that is broken.
rm out-old/deep/same.lode golden/deep/vertex.2.png; head -c 100 golden/deep/texture.1.png >cut.png; mv cut.png golden/deep/texture.1.png
run compare --golden golden out-old $CAMERA --camera 0,0,9,4,4,0
run compare --golden golden out-old --size 32x32 --quiet
# Of one asset: no line without its end, and the document has the reasons.
for camera in "$CAMERA" '--size 32x32' "$CAMERA --camera 0,0,9,4,4,0"; do
  run compare --golden golden/deep out-old/deep/vertex.lode $camera
  json golden compare --golden golden/deep out-old/deep/vertex.lode $camera --format json
  "$MESHLODE" compare --golden golden/deep out-old/deep/vertex.lode $camera --format json 2>/dev/null | grep -A6 '"missing"'
done
run compare --golden none out-old --quiet
run compare --golden golden out-old --fail-if 'file_bytes.ratio>1'
run compare --update a.lode
run compare --golden golden out-old --update -O x
run compare out-old/deep/vertex.lode out-old/deep/texture.lode out-new
run compare out-old out-new --manifest new.json
