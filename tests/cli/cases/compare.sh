# SPDX-License-Identifier: GPL-3.0-or-later
# compare: what changed between two assets as text and as JSON, and limits for it.
# ply COLOUR TRIANGLES: a strip of so many, in one colour.
ply() {
  printf 'ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n' $(($2 + 2))
  printf 'property uchar red\nproperty uchar green\nproperty uchar blue\n'
  printf 'element face %d\nproperty list uchar int vertex_indices\nend_header\n' "$2"
  local i
  for ((i = 0; i < $2 + 2; ++i)); do echo "$((i / 2)) $((i % 2)) 0 $1"; done
  for ((i = 0; i < $2; i += 2)); do printf '3 %d %d %d\n3 %d %d %d\n' $i $((i + 2)) $((i + 1)) $((i + 1)) $((i + 2)) $((i + 3)); done
}
mkdir old new red
ply '200 200 200' 2 >old/strip.ply
ply '200 200 200' 6 >new/strip.ply
ply '200 0 0' 2 >red/strip.ply
for name in old new red; do "$MESHLODE" build --quiet $name/strip.ply -o $name.lode; done
"$MESHLODE" build --quiet old/strip.ply -o fine.lode --grid 0.125
# Bytes and hashes are those of a version; what is counted here is not.
numbers() { grep -vE '_bytes|bytes_|^  [A-Z]{4} |level0_deviation' | sed -E 's/[0-9a-f]{32}/HASH/g'; }
echo '$ compare old.lode old.lode'
"$MESHLODE" compare old.lode old.lode --render --size 64x48 | numbers
echo '$ compare old.lode new.lode'
"$MESHLODE" compare old.lode new.lode | numbers
echo '$ compare old.lode fine.lode'
"$MESHLODE" compare old.lode fine.lode | numbers
json compare compare old.lode new.lode --format json
json compare compare old.lode red.lode --format json --render --size 64x48 --fail-if 'content_equal==false'
# Limits.
limit() {
  echo "\$ meshlode compare $1 $2 --fail-if $3"
  "$MESHLODE" compare "$1" "$2" --quiet --fail-if "$3" "${@:4}" 2>&1
  echo "exit $?"
}
limit old.lode old.lode 'file_bytes.ratio>1, content_equal==false, any(meshes).levels.change!=0'
limit old.lode new.lode 'totals.source_triangles.change>3, any(meshes).levels.change!=0'
limit old.lode new.lode 'any(meshes).source_triangles.ratio>=3, count(meshes_added)>0'
limit old.lode fine.lode 'any(settings).key==grid'
limit old.lode old.lode 'picture.psnr<40, picture.differing_share>0' --render --size 64x48
limit old.lode new.lode 'picture.triangles.change>0' --render --size 64x48
limit old.lode red.lode 'picture.psnr>=40' --render --size 64x48
limit old.lode red.lode 'picture.differing_pixels<100' --render --size 64x48
limit old.lode red.lode 'picture.psnr<40'
limit old.lode red.lode 'file_bytes>1'
limit old.lode red.lode ''
limit old.lode red.lode 'file_bytes.ration>1'
limit old.lode red.lode 'picture.psnr==null' --render --camera 0,0,0,0,0,0
"$MESHLODE" compare old.lode red.lode --render --size 64x48 --camera 0.5,0.5,3,0.5,0.5,0 | grep -A9 '^picture'
"$MESHLODE" compare old.lode red.lode --format json --fail-if 'any(meshes).source_triangles.new==2' 2>/dev/null | sed -n '/"failed"/,$p'
run compare old.lode
run compare old.lode missing.lode
run compare old/strip.ply old.lode
# Cut off, or with a byte of a page or an image changed that opening does not look at: nothing is said of such an asset.
head -c 1000 red.lode >cut.lode
run compare old.lode cut.lode | sed 's,says [0-9]*,says N,'
run compare cut.lode cut.lode --quiet | sed 's,says [0-9]*,says N,'
cp red.lode broken.lode
printf '\377' | dd of=broken.lode bs=1 seek=$(($(wc -c <broken.lode) - 40)) conv=notrunc status=none
run compare red.lode broken.lode
run compare broken.lode broken.lode --format json
rm cut.lode broken.lode
run compare old.lode red.lode --camera 0,0,1,0,0,0
rm -r old new red
files
