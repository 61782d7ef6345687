# SPDX-License-Identifier: GPL-3.0-or-later
# --fail-if: conditions that hold are told with place and value, and the exit code is 6; a key that there is not is a
# usage error with the nearest, before anything is built.
# ply TRIANGLES: a strip of so many.
ply() {
  printf 'ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n' $(($1 + 2))
  printf 'element face %d\nproperty list uchar int vertex_indices\nend_header\n' "$1"
  local i
  for ((i = 0; i < $1 + 2; ++i)); do echo "$((i / 2)) $((i % 2)) 0"; done
  for ((i = 0; i < $1; i += 2)); do printf '3 %d %d %d\n3 %d %d %d\n' $i $((i + 2)) $((i + 1)) $((i + 1)) $((i + 2)) $((i + 3)); done
}
mkdir in
ply 2 >in/small.ply
ply 6 >in/large.ply
"$MESHLODE" build --quiet in/large.ply -o large.lode
# budget CONDITIONS: what info says of them on stderr.
budget() {
  echo "\$ meshlode info large.lode --fail-if $1"
  "$MESHLODE" info large.lode --fail-if "$1" 2>&1 >/dev/null
  echo "exit $?"
}
budget 'totals.source_triangles>6, any(meshes).stuck_groups>0, file_bytes>1MiB'
budget 'totals.source_triangles>5'
budget 'totals.source_triangles >= 6 , any(meshes).clusters<2, count(meshes)==1, settings.preset==default'
budget 'any(meshes).any(levels).triangles>5'
budget 'all(meshes).stuck_groups==0'
budget 'meshes[0].levels[0].triangles!=6'
budget 'any(stuck).triangles>0, count(stuck)>0, count(images)>0'
budget 'sections["MESH"].bytes<1, byte_map.pages.colors>0'
# What is no budget.
budget 'totals.source_triangle>5'
budget 'totals.source_triangles'
budget 'totals.source_triangles>many'
budget 'meshes.clusters>1'
budget 'any(meshes.clusters)>1'
budget 'totals>1'
budget 'content_hash>1'
budget 'sections["MASH"].bytes>1'
budget 'any(any(meshes))>1'
budget 'totals.clusters>nan'
budget 'totals.clusters==nan'
budget 'totals.clusters>1e999'
budget ''  # a variable that somebody forgot to set
# As long as a word of the command line may be, and beyond what a budget may be.
"$MESHLODE" info large.lode --fail-if "$(head -c 130000 /dev/zero | tr '\0' '(')" 2>&1 >/dev/null | cut -c 1-80
for text in '(' 'any(' 'a[' 'a.' 'any(a).' "'" 'a>1,'; do
  "$MESHLODE" info large.lode --fail-if "$(yes "$text" | head -n 3000 | tr -d '\n')" 2>&1 >/dev/null |
    cut -c 1-80
done
# In every form: the same is printed with a budget as without, and the same fails.
for format in text json csv markdown; do
  "$MESHLODE" info large.lode --format $format >plain
  "$MESHLODE" info large.lode --format $format --fail-if 'totals.meshes>0, byte_map.pages.total<1' >judged 2>errors
  echo "$format: exit $?, $(wc -l <errors) line(s)"
  cmp plain judged
done
run info large.lode --quiet --fail-if 'totals.meshes>0'
rm plain judged errors
# A page that is broken: 3 in every form, whatever else holds; of the byte map no figure is within its limit.
cp large.lode broken.lode
printf '\377' | dd of=broken.lode bs=1 seek=$(($(wc -c <broken.lode) - 40)) conv=notrunc status=none
for format in text json csv markdown; do
  for budget in 'byte_map.pages.total>1MiB' 'totals.meshes>1' 'totals.meshes>0'; do
    echo "$format, $budget: $("$MESHLODE" info broken.lode --format $format --fail-if "$budget" 2>&1 >/dev/null)"
    "$MESHLODE" info broken.lode --format $format --fail-if "$budget" >/dev/null 2>&1 || echo "exit $?"
  done
done
head -c 1000 large.lode >cut.lode
run info cut.lode --fail-if 'totals.meshes>0' | sed 's,says [0-9]*,says N,'
rm broken.lode cut.lode
json info info large.lode --format json --fail-if 'totals.meshes>0'
run info missing.lode --fail-if 'totals.meshes>0'
# A batch goes on, the asset stays, a second look finds the same, and who asks for less is content.
run build --quiet in -O out --fail-if 'totals.source_triangles>2'
files
run build --quiet in -O out --fail-if 'totals.source_triangles>2' --cache cache
run build --quiet in -O out --fail-if 'totals.source_triangles>2' --cache cache
run build --quiet in -O out --fail-if 'totals.source_triangles>6' --cache cache
run build --quiet in -O out --fail-if 'totals.source_triangles>2' --fail-fast --junit junit.xml --report report.json
grep -c '<failure type="a check failed"' junit.xml
"$JSON_CHECK" "$SCHEMAS/report.schema.json" <report.json
grep -E '"(status|exit_code)"' report.json
rm -r out cache ./*.xml ./*.json
run build --quiet in -O out --fail-if 'totals.source_triangle>2'
run build in -O out --fail-if 'totals.source_triangles>2' --dry-run
files
