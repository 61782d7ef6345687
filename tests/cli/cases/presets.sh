# SPDX-License-Identifier: GPL-3.0-or-later
# A preset sets the error tier where none is asked for, is named in the asset, and changes bytes by what it spends.
cp "$DATA/rock.glb" a.glb
# What `info` says of the tier and of the preset, and the bytes of pages.
tell() {
  "$MESHLODE" info "$1" --format json | tr -d ' \n' | grep -oE '"(preset|error_tier)":"[a-z]*"' | sort -u
  "$MESHLODE" info "$1" | grep -E '^preset'
}
page_bytes() { "$MESHLODE" info "$1" | sed -n 's/^  PAGE *\([0-9,]*\).*/\1/p' | tr -d ,; }
code build --quiet a.glb -o plain.lode
code build --quiet a.glb -o default.lode --preset default
cmp plain.lode default.lode && echo "default is the default"
code build --quiet a.glb -o fast.lode --preset fast
code build --quiet a.glb -o best.lode --preset best
code build --quiet a.glb -o measured.lode --preset fast --error-tier measured
code build --quiet a.glb -o auto.lode --preset fast --error-tier auto
cmp fast.lode auto.lode && echo "auto is the preset's tier"
for name in default fast best measured; do
  echo "$name"
  tell $name.lode
  code validate --quiet $name.lode
done
[ "$(page_bytes best.lode)" -lt "$(page_bytes default.lode)" ] && [ "$(page_bytes default.lode)" -lt "$(page_bytes fast.lode)" ] &&
  echo "the more effort, the fewer bytes"
run build a.glb --preset slow
run build a.glb --error-tier exact
files
