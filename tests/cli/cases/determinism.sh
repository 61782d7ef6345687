# SPDX-License-Identifier: GPL-3.0-or-later
# The bytes do not depend on the thread count, the run, or the name and place of the file's folder (I10).
for scene in rock crystal city; do
  mkdir -p "elsewhere/$scene"
  cp "$DATA/$scene.glb" "$scene.glb"
  cp "$DATA/$scene.glb" "elsewhere/$scene/$scene.glb"
  code build --quiet "$scene.glb" -o one.lode --jobs 1
  code build --quiet "elsewhere/$scene/$scene.glb" -o two.lode --jobs 2
  code build --quiet "$scene.glb" -o four.lode --jobs 4
  for other in two four; do cmp one.lode $other.lode && echo "$scene: $other equals one"; done
done
code build --quiet crystal.glb -o plain.lode --codec none
for codec in strips; do
  code build --quiet crystal.glb -o packed.lode --codec $codec
  plain=$("$MESHLODE" info plain.lode --format json | grep content_hash)
  packed=$("$MESHLODE" info packed.lode --format json | grep content_hash)
  [ -n "$plain" ] && [ "$plain" = "$packed" ] && echo "$codec: the same content"
done
