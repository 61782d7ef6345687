# SPDX-License-Identifier: GPL-3.0-or-later
# report: a batch as a page, as Markdown, SARIF and annotations; against an older one; what it will not write over or read.
mkdir in
cp "$DATA/rock.glb" in/a.glb
cp "$DATA/crystal.glb" in/b.glb
head -c 2000 "$DATA/rock.glb" >"in/|<img src=x>.glb"
code build -q in -O out --preset fast --manifest old.json
rm in/b.glb; cp "$DATA/crystal.glb" in/c.glb
code build -q in -O out --preset fast --codec none --manifest new.json
run report new.json --against old.json --format markdown
run report new.json --format annotations
"$MESHLODE" report new.json --format sarif | python3 -c '
import json, sys
run, = json.load(sys.stdin)["runs"]
for r in run["results"]: print(r["level"], r["ruleId"], r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"])
print(run["invocations"])'
"$MESHLODE" report new.json --against old.json -o page/; echo "exit $?"
ls page
"$MESHLODE" report new.json --against old.json --format markdown | cmp - page/report.md
"$MESHLODE" report new.json --format sarif --jobs 1 --max-memory 1MB | cmp - page/report.sarif
for jobs in 1 7; do "$MESHLODE" report new.json --against old.json -o page/again.html --jobs $jobs && cmp page/index.html page/again.html; done
MESHLODE=$MESHLODE python3 - <<'END'
import base64, json, os, re, subprocess
page = open("page/index.html").read()
assert page.count("<script") == 2 and "<img" not in page
data = json.loads(re.search(r'id="data">(.*)</script>', page).group(1))
print(data["gone"], data["streams"])
for a in data["assets"]:
    print(a["input"], a["status"], a["bytes"] == sum(a["streams"]), "old" in a, a.get("link"), [f[:2] for f in a["findings"]])
    if "thumbnail" not in a: continue
    picture = base64.b64decode(a["thumbnail"])
    assert picture[8:12] == b"WEBP" and len(picture) < 4000, len(picture)
    drawn = subprocess.run([os.environ["MESHLODE"], "render", a["output"], "-o", "drawn.png", "--format", "json"], stdout=subprocess.PIPE)
    assert a["at_pixel"] == json.loads(drawn.stdout)["triangles"], "what render draws by its defaults"
    print(a["output"], a["triangles"], a["at_pixel"])
END
"$MESHLODE" report new.json --against old.json -o page/without.html --no-thumbnails
grep -c '"thumbnail"' page/without.html; grep -o '"at_pixel": [0-9]*' page/without.html
# A picture that lacks an image says so; the rest of the row is there.
mkdir hurt; cp "$DATA/foliage.glb" hurt/
python3 - hurt/foliage.glb <<'END'
import sys
data = bytearray(open(sys.argv[1], "rb").read())
data[data.index(b"\x89PNG") + 60] ^= 255
open(sys.argv[1], "wb").write(data)
END
code build -q hurt -O hurt/out --preset fast --manifest hurt.json
"$MESHLODE" report hurt.json | grep -oE '"thumbnail": "UklG|"thumbnail_note": "[^"]*"'
# Not the asset that the manifest lists, and one that is not there.
printf x >>out/a.lode; rm out/c.lode
run report new.json --format markdown
# What it reads stays what it is.
run report new.json -o new.json
run report new.json --against old.json -o old.json
run report new.json -o in/a.glb --format annotations
run report new.json -o page.md
run report new.json -o page/ --format markdown
run report in/a.glb
run report none.json
run report new.json --against none.json
