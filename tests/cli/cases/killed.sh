# SPDX-License-Identifier: GPL-3.0-or-later
# kill -9 at random moments, of two batches at once that share a cache: nothing broken is ever there, neither an asset nor an
# entry of the cache, the manifest can be read and lists no asset that is not there, the next run completes, and its bytes are
# those of a clean run. KILLS: how many batches are killed before
# they are done, at least (10; the slow test takes 50).
RANDOM=${SEED:-20}
mkdir in
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
for i in 1 2 3 4 5 6 7 8; do terrain $((10 + 5 * i)) "$i" >"in/$i.obj"; done
"$MESHLODE" build --quiet in -O clean --preset fast
# What undisturbed batches keep: entries have the same bytes under the same key, last/ under the output's.
started=${EPOCHREALTIME/[.,]/}
for folder in one two; do "$MESHLODE" build --quiet in -O $folder --preset fast --cache clean_cache; done
microseconds=$((${EPOCHREALTIME/[.,]/} - started))  # one builds all, the other copies: about what both take side by side
rm -r one/* two/*
# Whole files, each the clean one or none: also in the moment after a kill.
to_be_there='^Only in clean\|^Only in .*: \.meshlode-[^ ]*\.tmp$'
check() {
  local kind
  for kind in one two; do diff -rq clean $kind; done | grep -v "$to_be_there"
  for kind in asset record mesh last; do
    [ ! -d cache/$kind ] || diff -rq clean_cache/$kind cache/$kind
  done | grep -v "$to_be_there"
}
killed=0 first_killed=0 leftovers=0 rounds=0
while [ $((killed + first_killed)) -lt "${KILLS:-10}" ] && [ $rounds -lt $((20 * ${KILLS:-10})) ]; do
  rounds=$((rounds + 1))
  rm -rf one/*.lode one.json
  case $((RANDOM % 3)) in
    0) rm -rf cache ;;
    1) rm -rf cache/asset cache/record ;;  # meshes are left to be found
  esac
  "$MESHLODE" build --quiet in -O one --preset fast --cache cache --manifest one.json 2>>../stderr &
  first=$!
  "$MESHLODE" build --quiet in -O two --preset fast --cache cache --cache-limit 200KiB 2>>../stderr &
  second=$!
  late=$((RANDOM * microseconds / 32768))
  sleep "$((late / 1000000)).$(printf '%06d' $((late % 1000000)))"
  {  # The shell tells of a killed child, wherever that finds it.
    kill -KILL "$first"
    [ $((RANDOM % 2)) -ne 0 ] || kill -KILL "$second"
    wait "$first"; [ $? -ne 137 ] || first_killed=$((first_killed + 1))
    wait "$second"; [ $? -ne 137 ] || killed=$((killed + 1))
  } 2>>../stderr
  # On a busy machine both may be gone before there is a cache.
  leftovers=$((leftovers + $(find cache one two -name '.meshlode-*' 2>/dev/null | wc -l)))
  check
  [ ! -e one.json ] || "$MESHLODE" report one.json --format annotations >told || echo "a manifest that cannot be read"
  [ ! -e told ] || grep 'unreadable-asset' told
done
killed=$((killed + first_killed))
echo "killed in the middle: $killed batches, $first_killed of them the first of two, in $rounds rounds; they left $leftovers temporary files" >&3
[ "$killed" -ge "${KILLS:-10}" ] && echo "enough were killed"
"$MESHLODE" build --quiet in -O one --preset fast --cache cache; echo "exit $?"
"$MESHLODE" build --quiet in -O two --preset fast --cache cache; echo "exit $?"
for folder in one two; do diff -r clean "$folder" && echo "$folder: as a clean run"; done
"$MESHLODE" build in -O one --preset fast --cache cache 2>&1 | grep -o 'nothing to do[^;]*'
# What killed writers left in the cache is gone where it was written to since, and by the next trim everywhere.
"$MESHLODE" build --quiet in -O one --preset fast --cache cache --cache-limit 1GiB
find cache one two -name '.meshlode-*'
# The meshes alone: how many the trimming of a killed batch left depends on the moment, but each is taken.
meshes=$(find cache/mesh -type f | wc -l)
rm -r cache/asset cache/record one/*
"$MESHLODE" build --quiet in -O one --preset fast --cache cache --report report.json
[ "$(grep -c '"meshes_from_cache": 1,' report.json)" -eq "$meshes" ] && echo "all meshes of the cache are taken"
diff -r clean one && echo "from them: as a clean run"
check
