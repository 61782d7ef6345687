# SPDX-License-Identifier: GPL-3.0-or-later
# --textures: fewer texels, fewer bytes, what cannot be decoded stays and is named; the same for any number of threads,
# and verify knows what it did.
cat >make.py <<'END'
# A quad with a colour, a normal map and roughness of 64 texels, and an image that is none.
import base64, json, random, struct, zlib
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
def png(texel, side=64):
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(side)) for y in range(side))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
r = random.Random(1)
images = [png(lambda x, y: (4 * x, r.randrange(40), 3 * y)), png(lambda x, y: (118 + r.randrange(20), 118 + r.randrange(20), 255)),
          png(lambda x, y: (0, 100 + r.randrange(60), 0)), b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack("<4I", 0, 1, 48, 20) + b"\0" * 52]
parts = [struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0), struct.pack("<8f", 0, 0, 1, 0, 1, 1, 0, 1), struct.pack("<6H", 0, 1, 2, 0, 2, 3)] + images
views, data = [], b""
for part in parts:
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part)})
    data += part + b"\0" * (-len(part) % 4)
json.dump({"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}], "bufferViews": views,
  "images": [{"bufferView": 3 + i, "mimeType": "image/ktx2" if i == 3 else "image/png", "name": n} for i, n in enumerate(["color", "normal", "rough", "basis"])],
  "textures": [{"source": 0}, {"source": 1}, {"source": 2}, {"extensions": {"KHR_texture_basisu": {"source": 3}}}], "extensionsUsed": ["KHR_texture_basisu"],
  "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 2}}, "normalTexture": {"index": 1}, "emissiveTexture": {"index": 3}}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}, {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"}, {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0}, open("a.gltf", "w"))
END
python3 make.py
sizes() { sed -E 's/[0-9.]+(B|KiB|MiB| bytes)/N\1/g; s/: [0-9,]+, /: N, /; s/source [0-9,]+, /source N, /'; }
for words in keep resize:16 webp resize:16,webp:50; do
  code build -q a.gltf -o one.lode --textures $words --jobs 1
  code build -q a.gltf -o seven.lode --textures $words --jobs 7
  cmp one.lode seven.lode
  run verify one.lode --source a.gltf --quick --quiet
  "$MESHLODE" info one.lode | grep -E '^images  |image [0-9]|^ .*image/' | sizes
  json info info one.lode --format json
  mv one.lode $words.lode; rm seven.lode
done
ls -l *.lode | awk '{print $5, $NF}' | sort -n | awk '{print $2}'
# The asset has the source's document; extract names what the images are, and what it wrote is read.
"$MESHLODE" extract webp.lode --level 0 -o w.glb -q
python3 - <<'END'
import json, struct
b = open("w.glb", "rb").read(); d = json.loads(b[20:20 + struct.unpack("<I", b[12:16])[0]])
print(d["extensionsRequired"], [i["mimeType"] for i in d["images"]], d["textures"])
END
code build -q w.glb -o w.lode
"$MESHLODE" info w.lode --format json | python3 -c 'import json,sys; print([(i["mime_type"], i["width"], i["gpu_bytes"], i["source"]) for i in json.load(sys.stdin)["images"]])'
"$MESHLODE" render resize:16.lode -o r.png --size 32x32 -q --strict && echo drawn
# Plan and doctor say it before a build.
"$MESHLODE" plan a.gltf --textures resize:32 | sed -n '/^images/,/^features/p' | sizes
json plan plan a.gltf --textures resize:32,webp --format json
# Of images that a build keeps too, for they are too wide, of four colours, or damaged.
python3 - <<'END'
import base64, json
exec(open("make.py").read().split("r = random")[0])
def wide(width):
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, 2, 8, 0, 0, 0, 0)) + chunk(b"IDAT", zlib.compress((b"\0" + b"\0" * width) * 2)) + chunk(b"IEND", b"")
four = b"\xff\xd8\xff\xc0\x00\x14\x08\x00\x40\x00\x40\x04" + b"".join(bytes([i, 17, 0]) for i in range(1, 5)) + b"\xff\xd9"
d = json.load(open("a.gltf"))
for name, kind, data in [("wide", "png", wide(16384)), ("wider", "png", wide(17000)), ("four", "jpeg", four), ("broken", "png", b"\x89PNG")]:
    d["images"].append({"name": name, "uri": f"data:image/{kind};base64," + base64.b64encode(data).decode()})
json.dump(d, open("more.gltf", "w"))
END
"$MESHLODE" plan more.gltf --textures resize:32 | sed -n '/^images/,/^  kept .*images/p' | sizes
"$MESHLODE" plan more.gltf | grep ' images, ' | sizes
json plan plan more.gltf --textures resize:32,webp --format json
for words in resize:32 resize:32,webp; do
  code build -q more.gltf -o more.lode --textures $words
  "$MESHLODE" info more.lode --format json >info.json; "$MESHLODE" plan more.gltf --textures $words --format json >plan.json
  python3 - <<'END'
import json
plan, info = json.load(open("plan.json"))["images"], json.load(open("info.json"))["images"]
same = [(a["stored_width"], a["stored_height"], a["stored_gpu_bytes"]) == (b["width"], b["height"], b["gpu_bytes"]) for a, b in zip(plan, info)]
print(len(plan), len(info), same)
END
done
rm more.* info.json plan.json
"$MESHLODE" doctor a.gltf | grep -A3 heavy-images | grep -v costs | sizes
# In a file, and in the manifest; a cache tells them apart.
echo '{"textures": "resize:16"}' >meshlode.json
"$MESHLODE" build a.gltf -o s.lode --cache c --manifest m.json -q; cmp s.lode resize:16.lode
"$JSON_CHECK" "$SCHEMAS/manifest.schema.json" <m.json
grep -o '"textures": "[^"]*"' m.json
"$MESHLODE" build a.gltf -o s.lode --cache c --textures webp --dry-run
echo '{"textures": 16}' >meshlode.json; run build a.gltf -o s.lode
rm meshlode.json
for words in '' resize: webp:0 keep,webp png resize:99999; do run build a.gltf -o t.lode --textures "$words"; done
# An image that takes more memory than it may stays.
run build a.gltf -o t.lode --textures webp --max-decoded 1000 -q
run verify t.lode --source a.gltf --quick --quiet
"$MESHLODE" info t.lode | grep -E '^kept.*image [0-9]|^ .*image/' | sizes
rm t.lode
"$MESHLODE" build a.gltf -o s.lode --cache c --textures webp --max-decoded 1000 -q
"$MESHLODE" build a.gltf -o s.lode --cache c --textures webp --dry-run
# An image that is another one is found, whatever the settings say.
run verify webp.lode --source a.gltf --quick --quiet
sed 's/make/make/; s/4 \* x, r.randrange(40), 3 \* y/255 - 4 * x, 200, 255 - 3 * y/' make.py >other.py; cp a.gltf a.kept; python3 other.py
run verify webp.lode --source a.gltf --quick --force --quiet
mv a.kept a.gltf
rm *.lode *.py w.glb r.png a.gltf m.json; rm -r c
files
