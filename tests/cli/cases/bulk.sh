# SPDX-License-Identifier: GPL-3.0-or-later
# verify, validate, info, doctor and plan over many files: a row a file in the order given, for any number of threads,
# and what one file says of itself alone is in the list as it is.
mkdir -p in/deep
cp "$DATA/rock.glb" in/a.glb
cp "$DATA/rock.glb" in/deep/b.glb
cp "$DATA/city.glb" in/deep/c.glb
head -c 2000 "$DATA/rock.glb" >in/broken.glb
code build -q in -O out --preset fast --error-tier qem --manifest out/manifest.json
same() { "$MESHLODE" "$@" --jobs 1 >one.txt 2>&1; "$MESHLODE" "$@" --jobs 7 >seven.txt 2>&1; cmp one.txt seven.txt; rm one.txt seven.txt; }
run verify --manifest out/manifest.json --quick
same verify --manifest out/manifest.json --quick
run verify --manifest out/manifest.json --source in --quick
run verify out --source in --quick
run verify out/a.lode out/deep/b.lode --source in --quick
run verify 'out/**/*.lode' --source in --quick --quiet
(cd out && run verify '**/*.lode' --source ../in --quick)
run verify out/deep/c.lode out/a.lode --quick
run verify out/deep/c.lode out/a.lode --quick --source in/a.glb
run verify out --source in --gpu
run validate out
run info out missing.lode
same info out
run info out --fail-if 'totals.source_triangles>30000' --quiet
run info out --format csv
run plan in
same plan in --format json
run plan in --measure
run doctor in out --fail-on high
same doctor in out
run plan --manifest out/manifest.json --max-memory 1
run validate out --max-memory much
mkdir empty; run info empty
run info
# Each entry is what the file alone says.
for verb in info doctor validate; do
  "$MESHLODE" $verb out --format json >many.json
  for file in out/a.lode out/deep/b.lode out/deep/c.lode; do "$MESHLODE" $verb $file --format json >one-$(basename $file).json; done
  python3 - $verb <<'END'
import json, sys
many = json.load(open("many.json"))["files"]
for name, entry in zip("abc", many):
    one = json.load(open(f"one-{name}.lode.json"))
    if sys.argv[1] == "validate":
        one = one["files"][0]
    else:
        assert entry["error"] is None and entry["exit_code"] == 0
        entry = entry["result"]
    assert entry == one, name
print(sys.argv[1], len(many), "entries")
END
done
json bulk verify out --source in --quick --format json
json bulk info out --format json
json bulk doctor out in --format json
json validate validate out out/none.lode --format json
json bulk plan in --format json
# What was found wrong is below its row with the whole name, in the JUnit file, and stops nobody.
cp out/a.lode out/bad.lode
printf '\001' | dd of=out/bad.lode bs=1 seek=100000 conv=notrunc status=none
printf 'no asset' >'out/<img src=x onerror=1>&".lode'
run validate out --junit out/v.xml
sed 's/time="[0-9.]*"/time="T"/g' out/v.xml
run validate out/a.lode --junit out/a.lode
# Nor a file that a scene refers to.
printf '{"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"buffer.xml"}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}' >x.gltf
printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077\0\0\0\0' >buffer.xml; cp buffer.xml same.bin
for verb in doctor plan; do code $verb x.gltf --junit buffer.xml; cmp buffer.xml same.bin; done
cp out/a.lode asset.xml; run validate asset.xml --junit asset.xml; cmp out/a.lode asset.xml
(cd out && cp bad.lode ::error.lode && "$MESHLODE" validate '*.lode' | grep -c '^  \./::error'; rm ::error.lode)
run verify out/a.lode --source in/a.glb --quick --junit verify.xml --quiet
grep -c '<testcase' verify.xml
echo "two folders"
"$MESHLODE" build -q in/a.glb in/deep/c.glb -O golden --preset fast --error-tier qem; mkdir golden/deep; mv golden/c.lode golden/deep/c.lode
cp out/a.lode golden/lost.lode; rm -f out/*.xml out/bad.lode out/*img*
run compare golden out
same compare golden out --fail-if 'file_bytes.ratio>1.01'
run compare golden out --fail-if 'file_bytes.ratio>1.01' --quiet --junit compare.xml
"$MESHLODE" repack -q golden/a.lode -o out/a.lode --codec none
run compare golden out --fail-if 'file_bytes.ratio>1.01'
run compare golden out --render --size 64x48 --fail-if 'picture.psnr<99' --quiet
json bulk compare golden out --format json
run compare empty empty
run compare golden/a.lode out/a.lode --junit x.xml
