# SPDX-License-Identifier: GPL-3.0-or-later
# Shards and their merge: the manifest and the assets of one batch, to the byte but for what is measured; what is missing, twice,
# stale or changed is refused, and a shard that was killed leaves no manifest.
mkdir -p in/deep
# terrain SIDE SEED: an OBJ of 2 SIDE^2 triangles
terrain() {
  awk -v n="$1" -v seed="$2" 'BEGIN {
    srand(seed)
    for (y = 0; y <= n; ++y) for (x = 0; x <= n; ++x) printf "v %d %d %.4f\n", x, y, rand()
    for (y = 0; y < n; ++y) for (x = 0; x < n; ++x) {
      a = y * (n + 1) + x + 1
      printf "f %d %d %d\nf %d %d %d\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1
    }
  }'
}
for i in 1 2 3 4 5; do terrain $((4 + 2 * i)) "$i" >"in/$i.obj"; done
terrain 40 6 >in/deep/6.obj
printf '{"codec": "none"}' >in/deep/meshlode.json
printf 'broken' >in/deep/broken.glb
printf 'mtllib 5.mtl\n' >>in/5.obj
printf 'newmtl a\n' >in/5.mtl
timeless() { sed -E 's/^(      "(seconds|processor_seconds|peak_memory_bytes)": ).*/\1M,/'; }
# shard I/N OPTION…
shard() { "$MESHLODE" build --quiet in -O out --shard "$1" --manifest "parts/shard-${1%/*}.json" "${@:2}" 2>/dev/null; echo "shard $*: exit $?"; }

"$MESHLODE" build --quiet in -O out --manifest local.json 2>/dev/null; echo "local: exit $?"
mv out local
mkdir parts
for i in 1 2 3; do
  shard "$i/3"
  "$JSON_CHECK" "$SCHEMAS/manifest.schema.json" <"parts/shard-$i.json"
done
run merge parts/shard-3.json parts/shard-1.json parts/shard-2.json -o merged.json
"$JSON_CHECK" "$SCHEMAS/manifest.schema.json" <merged.json
cmp <(timeless <local.json) <(timeless <merged.json) && echo "the manifest of one batch"
diff -r local out && echo "the assets of one batch"

echo "what is not a whole batch"
run merge parts/shard-1.json parts/shard-3.json -o m.json
run merge parts/*.json parts/shard-2.json -o m.json
run merge local.json -o m.json
run merge parts/shard-1.json missing.json -o m.json
printf '{"shard": ' >cut.json; run merge cut.json -o m.json; rm cut.json
sed 's|"out/2.lode"|"out/3.lode"|' parts/shard-2.json >foreign.json
cmp -s foreign.json parts/shard-2.json || run merge parts/shard-[13].json foreign.json -o m.json
sed 's|"exit_code": 3|"exit_code": 0|' parts/shard-2.json >foreign.json
run merge parts/shard-[13].json foreign.json -o m.json
rm foreign.json
mkfifo pipe; run merge pipe -o m.json; rm pipe
run merge parts/*.json -o parts/shard-2.json
ln -s out/1.lode asset.json; run merge parts/*.json -o asset.json
run merge parts/*.json -o in/5.mtl
run merge parts/*.json
cp out/2.lode kept; printf 'x' >>out/2.lode
run merge parts/*.json -o m.json
mv kept out/2.lode
shard 2/3 --codec none
run merge parts/*.json -o m.json
shard 2/3
terrain 60 1 >in/1.obj
shard 2/3
"$MESHLODE" merge parts/*.json -o m.json 2>&1 | grep -o 'inputs or --shard-costs changed between shards.*'
terrain 6 1 >in/1.obj
cp in/2.obj in/new.obj
shard 2/3
run merge parts/*.json -o m.json
rm in/new.obj

echo "with the other options of a batch"
words=(--cache cache --fail-if 'totals.source_triangles>1000')
"$MESHLODE" build --quiet in -O out --manifest local-2.json "${words[@]}" 2>/dev/null; echo "local: exit $?"
# One without the cache: the manifests are of one program all the same.
shard 1/3 "${words[@]}" --junit junit.xml --report report.json --depfile depfile
grep -o 'testsuites name="meshlode" tests="[0-9]*" failures="[0-9]*"' junit.xml
grep -c '"output":' report.json; grep -c '^out/' depfile
shard 2/3 --fail-if 'totals.source_triangles>1000'
shard 3/3 "${words[@]}"
code merge --quiet parts/*.json -o m.json
# With a cache and without.
built() { timeless <"$1" | sed -E -e 's/"(unchanged|cached)"/"built"/' -e 's/^(        "(use|reason|meshes)": ).*/\1C/'; }
[ -s m.json ] && cmp <(built local-2.json) <(built m.json) && echo "the manifest of one batch"
run build in -O out --shard 2/3 --cache cache --dry-run
rm -rf cache junit.xml report.json depfile local-2.json m.json

echo "a shard that is killed"
for i in 1 2 3; do shard "$i/3"; done
terrain 200 7 >in/deep/large.obj
for i in 1 2 3; do shard "$i/3" --dry-run; done
"$MESHLODE" build --quiet in -O out --shard 1/3 --manifest parts/shard-1.json 2>/dev/null &
until [ ! -e parts/shard-1.json ]; do sleep 0.01; done
{ kill -KILL $!; wait $!; } 2>/dev/null  # the shell tells of a killed child, wherever that finds it
[ -e parts/shard-1.json ] || echo "its manifest is gone"
rm in/deep/large.obj
run merge parts/*.json -o m.json
shard 1/3
code merge --quiet parts/*.json -o m.json
cmp <(timeless <local.json) <(timeless <m.json) && echo "the manifest of one batch"

echo "balanced by what the last run took"
# The smallest file took longest; the others' times are all different, and the same on every machine that runs this.
awk '/"input": "in\/1.obj"/ { first = 1 } /"processor_seconds"/ { n++; sub(/: .*/, ": " (first ? 100 : 0.25 * n) ","); first = 0 } 1' \
  local.json >costs.json
costs() { for i in 1 2 3; do shard "$i/3" --shard-costs costs.json "$@"; done; }
costs --dry-run
rm -r out parts; mkdir parts
costs
rm parts/shard-2.json
run merge parts/*.json -o m.json
shard 2/3 --shard-costs costs.json
code merge --quiet parts/*.json -o m.json
cmp <(timeless <local.json) <(timeless <m.json) && diff -r local out && echo "the manifest and the assets of one batch"
shard 2/3
"$MESHLODE" merge parts/*.json -o m.json 2>&1 | grep -o 'inputs or --shard-costs.*'
run build in -O out --shard-costs costs.json
run build in -O out --shard 1/3 --shard-costs parts/shard-1.json
sed 's/"complete": true/"complete": false/' costs.json >working.json
run build in -O out --shard 1/3 --shard-costs working.json
run build in -O out --shard 1/3 --shard-costs in/1.obj
run build in -O out --shard 1/3 --shard-costs costs.json --manifest costs.json
sed 's|"input": "in/|"input": "elsewhere/|' costs.json >other.json
run build in -O out --shard 1/3 --shard-costs other.json
rm costs.json working.json other.json
for i in 1 2 3; do shard "$i/3"; done

echo "usage"
run build in -O out --shard 4/3
run build in -O out --shard 1/2 --fail-fast
run build in/1.obj -o 1.lode --shard 2/2 --manifest none.json
ln -s in/1.obj scene.json
run build in/1.obj -o 1.lode --shard 2/2 --manifest scene.json
mkdir nothing
run build nothing -O out --shard 1/1 --manifest none.json
run merge none.json -o m.json
run build in -O out --shard 1/2 --manifest a.json --manifest b.json
"$MESHLODE" build in -O dry --shard 2/3 --dry-run
echo "exit $?"
files
