# SPDX-License-Identifier: GPL-3.0-or-later
# The cache: a second run does nothing, a change rebuilds its dependants alone, and every asset is what a clean build gives.
one='\000\000\200\077' zero='\000\000\000\000'
scene() {
  printf "$zero$zero$zero$one$zero$zero$zero$one$zero" >"$1.bin"
  printf 'a picture' >"$1.png"
  printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"%s.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"images":[{"uri":"%s.png"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}' \
    "$(basename "$1")" "$(basename "$1")" >"$1.gltf"
}
mkdir in
scene in/a; scene in/b; scene in/c
# statuses ARGS…: the last line of the summary
statuses() { "$MESHLODE" build in -O out --cache cache "$@" 2>&1 | tail -n 1 | sed 's/; [0-9,]* triangles.*//'; }
run build in -O out --cache cache --dry-run
files
statuses
touch -d '2001-01-01' out/*.lode
statuses
echo "written again: $(find out -name '*.lode' -newermt 2002-01-01 | wc -l)"
run build in -O out --cache cache --dry-run
printf 'A picture' >in/b.png
run build in -O out --cache cache --dry-run
statuses
run build in -O out --cache cache --dry-run --codec none --normal-error 0.2
statuses --normal-error 0.2
rm out/a.lode
run build in -O out --cache cache --dry-run --normal-error 0.2
statuses --normal-error 0.2
"$MESHLODE" build --quiet in -O clean --normal-error 0.2 && diff -r out clean && echo "as a clean build"
echo "by the environment: $(MESHLODE_CACHE=cache "$MESHLODE" build in -O env --normal-error 0.2 2>&1 | tail -n 1 | sed 's/; [0-9,]* triangles.*//')"
echo "not by the environment: $(MESHLODE_CACHE=cache "$MESHLODE" build in -O env --no-cache 2>&1 | tail -n 1 | sed 's/; [0-9,]* triangles.*//')"
# A scene that moved is the same scene.
mkdir elsewhere && cp in/a.* elsewhere
"$MESHLODE" build elsewhere/a.gltf -o moved.lode --cache cache --normal-error 0.2 2>&1 | grep -c 'from the cache'
mkdir mine && printf 'thesis' >mine/work.txt
run build in/a.gltf -o a.lode --cache mine
run build in/a.gltf -o a.lode --cache in/a.bin
# What cannot be kept is said, and the asset is written all the same.
rm -r cache/record && printf 'in the way' >cache/record
"$MESHLODE" build --quiet in/a.gltf -o blocked.lode --cache cache 2>../stderr; echo "exit $?, $(grep -c '^meshlode: cache/record' ../stderr) line"
rm cache/record
statuses --cache-limit 2KiB
echo "within the limit: $(find cache/*/ -type f -printf '%s\n' | awk '{ sum += $1 } END { print (sum <= 2048) }')"
echo "what the manifest says of the cache"
mkdir told; cp "$DATA/city.glb" told/a.glb
for preset in fast fast default; do
  "$MESHLODE" build -q told/a.glb -O told/out --preset $preset --cache told/cache --manifest told/m.json; echo "exit $?"
  grep -A 3 '"cache": ' told/m.json
done
"$MESHLODE" build -q told/a.glb -O told/out --manifest told/m.json; grep -A 3 '"cache": ' told/m.json
# Linux tells how much memory a job took; what it does not tell is null.
grep -cE '"peak_memory_bytes": ([1-9][0-9]{6,}|null),$' told/m.json
"$JSON_CHECK" "$SCHEMAS/manifest.schema.json" <told/m.json
echo "another error tier measures the triangles that the cache has"
for tier in qem measured certified qem; do
  "$MESHLODE" build -q told/a.glb -o tier.lode --cache tiers --error-tier $tier --manifest tier.json; echo "exit $?"
  "$MESHLODE" build -q told/a.glb -o clean.lode --no-cache --error-tier $tier; cmp tier.lode clean.lode
  grep -A 3 '"cache": ' tier.json
done
# Built are assets whose pages depend on the tier, and scenes whose meshes may have tiers of their own.
for words in '--preset fast' '--promise texels' '--page-order covisible' rules; do
  [ "$words" != rules ] || { printf '{"meshes": {"*": {"drop": "TEXCOORD_0"}}}' >told/meshlode.json; words=; }
  for tier in qem measured; do
    "$MESHLODE" build -q told/a.glb -o tier.lode --cache tiers $words --error-tier $tier --manifest tier.json
    "$MESHLODE" build -q told/a.glb -o clean.lode --no-cache $words --error-tier $tier; cmp tier.lode clean.lode
    grep -A 2 '"use": "miss"' tier.json
  done
done
rm told/meshlode.json
echo "the cache by itself"
# What entries weigh is not asked here, but that they do.
weightless() { sed -E 's/ [1-9][0-9,]*$/ B/'; }
"$MESHLODE" build -q told/a.glb -O told/out --preset fast --cache own --quiet
run cache own | weightless
json cache cache own --stats --format json
run cache own --verify | weightless
for entry in own/asset/*/* own/mesh/*/*; do printf '\001' | dd of="$entry" bs=1 seek=1000 conv=notrunc status=none; done
run cache own --verify | weightless
run cache own --verify --quiet
"$MESHLODE" build -q told/a.glb -O told/out --preset fast --cache own; echo "exit $?"
MESHLODE_CACHE=own json cache cache --trim 100KiB --format json
run cache own --clear | weightless
ls -A own; "$MESHLODE" build -q told/a.glb -O told/out --preset fast --cache own; echo "exit $?"
# Nothing else is taken for a cache, or made one.
mkdir other; touch other/file
run cache other --clear
run cache none --clear
mkdir nothing; run cache nothing --stats --quiet; run cache nothing --clear --quiet; ls -A other nothing
# Another program's cache is not ours, and no link leads out of one.
entry=0123456789abcdef0123456789abcd
mkdir -p foreign/asset/ab beside; echo 'Signature: 8a477f597d28d172789f06886806bc55' >foreign/CACHEDIR.TAG
touch foreign/asset/ab/$entry beside/$entry
run cache foreign --clear; ls foreign/asset/ab
ln -s "$PWD/beside" own/asset/ff; run cache own --verify --quiet; run cache own --clear --quiet; ls beside; rm own/asset/ff
run cache own --clear --verify
run cache own --trim much
run cache
