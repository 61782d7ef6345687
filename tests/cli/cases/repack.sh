# SPDX-License-Identifier: GPL-3.0-or-later
# Another codec without the scene: the bytes of a build with that codec, from every codec to every other.
codecs="none strips"
cp "$DATA/city.glb" a.glb  # five meshes
for codec in $codecs; do
  code build --quiet a.glb -o "$codec.lode" --codec "$codec"
done
for from in $codecs; do
  for to in $codecs; do
    "$MESHLODE" repack --quiet "$from.lode" -o out.lode --codec "$to" || echo "failed: $from to $to"
    cmp out.lode "$to.lode" || echo "other bytes: $from to $to"
    rm -f out.lode
  done
done
cp "$DATA/rock.glb" b.glb  # with an image
code build --quiet b.glb -o b.lode --codec none
code build --quiet b.glb -o b_strips.lode --codec strips
for jobs in 1 3; do
  code repack --quiet b.lode -o "out$jobs.lode" --codec strips --jobs $jobs
  cmp "out$jobs.lode" b_strips.lode && echo same bytes
done
code validate --quiet out1.lode
hash_of() { "$MESHLODE" info "$1" --format json | grep -o '"content_hash": *"[0-9a-f]*"'; }
[ "$(hash_of b.lode)" = "$(hash_of out1.lode)" ] && echo same content
"$MESHLODE" repack b.lode -o out.lode --codec none | sed 's/[0-9]\{4,\} bytes/N bytes/g; s/[0-9a-f]\{32\}/HASH/'
code verify out.lode --source b.glb --quick --quiet

run repack b.lode
run repack b.lode -o c.lode
run repack b.lode -o c.lode --codec gzip
# Codecs that are no longer written: every reader refuses their pages by name.
for codec in lz4 zstd draco; do
  "$STORE_BY" $codec none.lode $codec.lode
  run repack none.lode -o c.lode --codec $codec
  run repack $codec.lode -o c.lode --codec strips
  code info $codec.lode
  run validate $codec.lode
done
run build a.glb -o c.lode --codec zstd
run extract lz4.lode -o c.glb --error 1
run measure zstd.lode --source a.glb -o c.lode
run doctor draco.lode
run repack b.lode -o b.lode --codec none
ln -s b.lode link
run repack b.lode -o link --codec none
run repack missing.lode -o c.lode --codec none
run repack a.glb -o c.lode --codec none
for size in 0 1 127 128 1000 5000 20000 $(($(wc -c <b.lode) - 1)); do
  head -c "$size" b.lode >short.lode
  code repack --quiet short.lode -o c.lode --codec none
done
# A bit in each of 40 places all over the file: refused, or one that nothing reads (between sections).
last=$(($(wc -c <strips.lode) - 1)) refused=0
for i in $(seq 0 39); do
  cp strips.lode changed.lode
  at=$((i * last / 39))
  byte=$(od -An -tu1 -j $at -N 1 strips.lode)
  printf "\\$(printf %o $((byte ^ 16)))" | dd of=changed.lode bs=1 seek=$at conv=notrunc status=none
  "$MESHLODE" repack --quiet changed.lode -o c.lode --codec none 2>../stderr
  case $? in
    0) cmp c.lode none.lode; rm c.lode ;;
    3) refused=$((refused + 1)) ;;
    *) echo "byte $at: $(cat ../stderr)" ;;
  esac
done
[ $refused -ge 30 ] && echo "changed bytes: refused"
rm changed.lode
# A byte of the image, which no checksum that opening looks at covers.
cp b.lode broken.lode
printf '\001' | dd of=broken.lode bs=1 seek=$(($(wc -c <b.lode) - 100)) conv=notrunc status=none
run repack broken.lode -o c.lode --codec none
run repack b.lode -o c.lode --codec none --max-decoded 0x
run repack b.lode -o no/such/folder/c.lode --codec none
files
