# SPDX-License-Identifier: GPL-3.0-or-later
# An asset whose pages or images are not what was written: the tables are sound, and no verb that looks at the rest says 0.
# flip FILE SECTION: changes the byte in the middle of a section.
flip() {
  local i at bytes middle value
  for ((i = 0; i < 64; ++i)); do
    [ "$(dd if="$1" bs=1 skip=$((64 + 64 * i)) count=4 status=none | tr -d '\0')" = "$2" ] || continue
    read -r at bytes < <(od -An -v -t u8 -j $((80 + 64 * i)) -N 16 "$1")
    middle=$((at + bytes / 2))
    value=$(od -An -v -t u1 -j $middle -N 1 "$1")
    printf "$(printf '\\x%x' $((value ^ 255)))" | dd of="$1" bs=1 seek=$middle conv=notrunc status=none
    return
  done
  echo "no section $2"
}
# told ARGS…: the exit code, what is on stderr, and whether anything was printed.
told() {
  local status
  "$MESHLODE" "$@" >../stdout 2>../stderr; status=$?
  echo "\$ meshlode $*"
  grep '^meshlode: ' ../stderr
  echo "exit $status, $([ -s ../stdout ] && echo something || echo nothing) printed"
}
"$MESHLODE" build "$DATA/foliage.glb" -o whole.lode --quiet --error-tier qem
cp whole.lode page.lode && flip page.lode PAGE
cp whole.lode image.lode && flip image.lode BLOB
for file in page.lode image.lode; do
  for format in text json csv markdown; do told info $file --format $format; done
  told info $file --quiet
  told info $file --stuck
  # What holds of the tables is told, and 3 is worse than 6; of the bytes of pages nothing is known.
  told info $file --quiet --fail-if 'totals.meshes>1'
  told info $file --quiet --fail-if 'totals.meshes>0'
  told info $file --quiet --fail-if 'byte_map.pages.total<1, totals.meshes>0'
  told doctor $file --quiet
  told doctor $file --fail-on not-finite
  told compare whole.lode $file
  told compare $file whole.lode --quiet
  told validate $file --quiet
  told verify $file --quick --quiet --source "$DATA/foliage.glb" | sed 's, [^ ]*/foliage, foliage,'
  told render $file -o out.png --size 64x64 --pixel-error 0.001 --strict --quiet
  told render $file -o out.png --size 64x64 --pixel-error 0.001 --quiet
  told render $file -o out.png --size 64x64 --view clusters --quiet
  told extract $file -o out.glb --level 0 --quiet
  told repack $file -o out.lode --codec none --quiet
done
"$MESHLODE" info page.lode --format json 2>/dev/null | grep -o '"byte_map": *null'
json info info page.lode --format json
for format in text json csv markdown; do code info whole.lode --format $format; done
files
